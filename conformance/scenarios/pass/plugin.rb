require "rtf"

class Pass < RTF::TestCase
  def run
    report("hello")
    check(1 == 1, "one is one")
  end

  def tear_down
    report("torn down")
  end
end
