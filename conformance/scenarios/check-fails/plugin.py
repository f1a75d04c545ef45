import rtf


class CheckFails(rtf.TestCase):
    def run(self):
        self.check(False, "the gripper is closed")
        self.report("still here")

    def tearDown(self):
        self.report("torn down")
