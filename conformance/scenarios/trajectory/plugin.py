import rtf


class Trajectory(rtf.TestCase):
    def run(self):
        self.sample("q", 0, "rad", time=0.5)
        self.sample("q", 1, "rad", time=1.5)
        self.sample("q", 1, "rad", time=2.5)
        self.check_trajectory("q", "golden/a.csv", tolerance=0.05)
        self.check_trajectory("q", "golden/b.csv", 0.5, align="dtw", band=0.25)
        self.report("the test continues")
