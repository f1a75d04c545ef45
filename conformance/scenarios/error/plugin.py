import rtf


class Error(rtf.TestCase):
    def run(self):
        self.error("no encoder found")

    def tearDown(self):
        self.report("torn down")
