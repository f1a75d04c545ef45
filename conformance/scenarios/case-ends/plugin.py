import rtf


class CaseEnds(rtf.TestCase):
    def run(self):
        with self.case("assertion"):
            self.require(False, "it moves")
        with self.case("error"):
            self.error("no bench")
        with self.case("exception"):
            raise ValueError("surprise")
        with self.case("after"):
            pass
