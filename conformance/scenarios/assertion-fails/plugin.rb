require "rtf"

class AssertionFails < RTF::TestCase
  def run
    require(false, "the arm is calibrated")
    report("unreachable")
  end

  def tear_down
    report("torn down")
  end
end
