require "rtf"

class ChildLeft < RTF::TestCase
  def run
    spawn(%w[sleep rtf-left-behind], "1000", pgroup: true)
    report("child started")
  end
end
