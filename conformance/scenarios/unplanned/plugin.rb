require "rtf"

class Unplanned < RTF::TestCase
  def run
    plan_cases(%w[a b])
    self.case("a") { nil }
  end
end
