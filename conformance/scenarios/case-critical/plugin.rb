require "rtf"

class CaseCritical < RTF::TestCase
  def run
    self.case("dangerous") { require_critical(false, "the arm is free") }
    self.case("never") { nil }
  end
end
