require "rtf"

class FaultUndeclared < RTF::TestCase
  def run
    fault("drop")
    report("not reached")
  end
end
