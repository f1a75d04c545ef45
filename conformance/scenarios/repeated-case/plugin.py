import rtf


class RepeatedCase(rtf.TestCase):
    def run(self):
        for _ in range(2):
            with self.case("pose"):
                pass
