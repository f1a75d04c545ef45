import rtf


class Monitor(rtf.TestCase):
    def run(self):
        self.monitor("always(level < 2m)")
