require "rtf"

class Skip < RTF::TestCase
  def run
    report("before")
    skip("no camera")
    report("after")
  end

  def tear_down
    report("torn down")
  end
end
