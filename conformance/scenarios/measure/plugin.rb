require "rtf"

class Measure < RTF::TestCase
  def run
    measure("position error", 0.02, "rad", high: 0.05)
    measure("rate", 87.5, "Hz", low: 95, high: 105)
  end
end
