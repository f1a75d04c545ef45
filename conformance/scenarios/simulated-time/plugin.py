import rtf


class SimulatedTime(rtf.TestCase):
    def run(self):
        start = self.now()
        self.sleep(20)
        self.check(self.now() - start >= 20, "twenty seconds have passed")
        self.wait_until(lambda: False, 10, "the door to open")
