require "rtf"

class CaseSkipped < RTF::TestCase
  def run
    self.case("gripper") { skip("no gripper is mounted") }
    self.case("arm") { nil }
  end
end
