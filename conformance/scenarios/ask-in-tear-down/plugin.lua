function TestCase.run()
  rtf.report("running")
end

function TestCase.tearDown()
  rtf.ask("Is the hand closed?", nil, nil, "no")
  rtf.report("not reached")
end
