function TestCase.run()
  rtf.check(false, "the gripper is closed")
  rtf.report("still here")
end

function TestCase.tearDown()
  rtf.report("torn down")
end
