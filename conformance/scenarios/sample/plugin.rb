require "rtf"

class Sample < RTF::TestCase
  def run
    sample("elbow", 0.25, "rad", high: 1.5, time: 0.5)
    sample("current", 2, time: 0.5)
    sample("elbow", 1.5, "rad", high: 1.5, time: 1)
    report("what was sampled comes before")
    taken = 0
    sample_for("ramp", 0.05, 20) { taken += 1 }
    sample("elbow", 1.75, "rad", low: -1.5, high: 1.5, time: 1.25)
    sample("elbow", 2, "rad", low: -1.5, high: 1.5, time: 1.5)
  end
end
