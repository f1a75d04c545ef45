import rtf


class Measure(rtf.TestCase):
    def run(self):
        self.measure("position error", 0.02, "rad", high=0.05)
        self.measure("rate", 87.5, "Hz", 95, 105)
