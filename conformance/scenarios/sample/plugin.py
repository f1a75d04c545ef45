import itertools

import rtf


class Sample(rtf.TestCase):
    def run(self):
        self.sample("elbow", 0.25, "rad", high=1.5, time=0.5)
        self.sample("current", 2, time=0.5)
        self.sample("elbow", 1.5, "rad", high=1.5, time=1)
        self.report("what was sampled comes before")
        taken = itertools.count(1)
        self.sample_for("ramp", 0.05, 20, lambda: next(taken))
        self.sample("elbow", 1.75, "rad", -1.5, 1.5, time=1.25)
        self.sample("elbow", 2, "rad", -1.5, 1.5, time=1.5)
