require "rtf"

class NestedCases < RTF::TestCase
  def run
    self.case("Arm") do
      self.case("Moves") { check(false, "it moves") }
      self.case("Stops") { nil }
    end
    self.case("Hand") { nil }
  end
end
