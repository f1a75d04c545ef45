require "rtf"

class InterruptedSleep < RTF::TestCase
  def run
    report("sleeping")
    sleep(1000)
  end

  def tear_down
    report("torn down")
  end
end
