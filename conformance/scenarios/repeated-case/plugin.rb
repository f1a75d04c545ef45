require "rtf"

class RepeatedCase < RTF::TestCase
  def run
    2.times { self.case("pose") { nil } }
  end
end
