require "rtf"

class Trajectory < RTF::TestCase
  def run
    sample("q", 0, "rad", time: 0.5)
    sample("q", 1, "rad", time: 1.5)
    sample("q", 1, "rad", time: 2.5)
    check_trajectory("q", "golden/a.csv", 0.05)
    check_trajectory("q", "golden/b.csv", 0.5, align: "dtw", band: 0.25)
    report("the test continues")
  end
end
