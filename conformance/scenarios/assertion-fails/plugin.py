import rtf


class AssertionFails(rtf.TestCase):
    def run(self):
        self.require(False, "the arm is calibrated")
        self.report("unreachable")

    def tearDown(self):
        self.report("torn down")
