import rtf


class NestedCases(rtf.TestCase):
    def run(self):
        with self.case("Arm"):
            with self.case("Moves"):
                self.check(False, "it moves")
            with self.case("Stops"):
                pass
        with self.case("Hand"):
            pass
