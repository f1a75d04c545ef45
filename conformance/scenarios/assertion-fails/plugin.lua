function TestCase.run()
  rtf.require(false, "the arm is calibrated")
  rtf.report("unreachable")
end

function TestCase.tearDown()
  rtf.report("torn down")
end
