function TestCase.run()
  rtf.report("before")
  rtf.skip("no camera")
  rtf.report("after")
end

function TestCase.tearDown()
  rtf.report("torn down")
end
