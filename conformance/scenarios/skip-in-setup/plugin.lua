function TestCase.setup()
  rtf.skip("no robot")
end

function TestCase.run()
  rtf.report("never")
end

function TestCase.tearDown()
  rtf.report("torn down")
end
