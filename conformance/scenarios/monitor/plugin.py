import rtf


class Monitor(rtf.TestCase):
    def run(self):
        self.sample("level", 5, "m")
        self.monitor("always(level < 2m)", name="low")
        self.monitor("always(level > 0m)", severity="stop")
        self.monitor("always(level < 2kg)", name="wrong unit", severity="error")
        self.sample("level", 1, "m")
        self.sample("level", 3, "m")
