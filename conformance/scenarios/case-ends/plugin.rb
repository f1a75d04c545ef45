require "rtf"

class CaseEnds < RTF::TestCase
  def run
    self.case("assertion") { require(false, "it moves") }
    self.case("error") { error("no bench") }
    self.case("exception") { raise "surprise" }
    self.case("after") { nil }
  end
end
