require "rtf"

class Abort < RTF::TestCase
  def run
    report("before the abort")
    Process.kill(:ABRT, Process.pid)
    sleep
  end
end
