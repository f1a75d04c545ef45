import rtf


class CaseSkipped(rtf.TestCase):
    def run(self):
        with self.case("gripper"):
            self.skip("no gripper is mounted")
        with self.case("arm"):
            pass
