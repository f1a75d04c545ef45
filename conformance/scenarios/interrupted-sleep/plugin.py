import rtf


class InterruptedSleep(rtf.TestCase):
    def run(self):
        self.report("sleeping")
        self.sleep(1000)

    def tearDown(self):
        self.report("torn down")
