require "rtf"

class Error < RTF::TestCase
  def run
    error("no encoder found")
  end

  def tear_down
    report("torn down")
  end
end
