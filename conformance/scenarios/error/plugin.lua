function TestCase.run()
  rtf.error("no encoder found")
end

function TestCase.tearDown()
  rtf.report("torn down")
end
