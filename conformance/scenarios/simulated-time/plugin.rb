require "rtf"

class SimulatedTime < RTF::TestCase
  def run
    start = now
    sleep(20)
    check(now - start >= 20, "twenty seconds have passed")
    wait_until(10, "the door to open") { false }
  end
end
