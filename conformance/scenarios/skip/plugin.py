import rtf


class Skip(rtf.TestCase):
    def run(self):
        self.report("before")
        self.skip("no camera")
        self.report("after")

    def tearDown(self):
        self.report("torn down")
