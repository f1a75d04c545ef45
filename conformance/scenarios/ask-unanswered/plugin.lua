function TestCase.run()
  rtf.ask("Is the hand closed?", { "yes", "no" })
  rtf.report("not reached")
end

function TestCase.tearDown()
  rtf.report("torn down")
end
