require "rtf"

class WaitUntil < RTF::TestCase
  def run
    wait_until(0.2, "the door to open") { false }
  end
end
