import rtf


class Cases(rtf.TestCase):
    def run(self):
        with self.case("joint 0", joint=0):
            self.report("moved")
        with self.case("joint 1"):
            self.check(False, "joint 1 moves")
            self.report("still here")
        with self.case("joint 2"):
            self.check(True, "joint 2 moves")
