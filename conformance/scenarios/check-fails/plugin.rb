require "rtf"

class CheckFails < RTF::TestCase
  def run
    check(false, "the gripper is closed")
    report("still here")
  end

  def tear_down
    report("torn down")
  end
end
