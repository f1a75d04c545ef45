function TestCase.run()
  rtf.report("hello")
  rtf.check(true, "one is one")
end

function TestCase.tearDown()
  rtf.report("torn down")
end
