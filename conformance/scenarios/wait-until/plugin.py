import rtf


class WaitUntil(rtf.TestCase):
    def run(self):
        self.wait_until(lambda: False, 0.2, "the door to open")
