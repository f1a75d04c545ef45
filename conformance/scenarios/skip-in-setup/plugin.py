import rtf


class SkipInSetup(rtf.TestCase):
    def setup(self, args):
        self.skip("no robot")

    def run(self):
        self.report("run was called")

    def tearDown(self):
        self.report("torn down")
