import rtf


class Unplanned(rtf.TestCase):
    def run(self):
        self.plan_cases(["a", "b"])
        with self.case("a"):
            pass
