require "rtf"

class Cases < RTF::TestCase
  def run
    self.case("joint 0", joint: 0) { report("moved") }
    self.case("joint 1") do
      check(false, "joint 1 moves")
      report("still here")
    end
    self.case("joint 2") { check(true, "joint 2 moves") }
  end
end
