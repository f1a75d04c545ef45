function TestCase.setup()
  return false
end

function TestCase.run()
  rtf.report("never")
end

function TestCase.tearDown()
  rtf.report("torn down")
end
