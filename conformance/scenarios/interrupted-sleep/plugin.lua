function TestCase.run()
  rtf.report("sleeping")
  rtf.sleep(1000)
end

function TestCase.tearDown()
  rtf.report("torn down")
end
