import rtf


class CaseCritical(rtf.TestCase):
    def run(self):
        with self.case("dangerous"):
            self.require_critical(False, "the arm is free")
        with self.case("never"):
            pass
