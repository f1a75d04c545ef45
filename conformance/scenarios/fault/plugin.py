import rtf


def ticks():
    with open("tick") as file:
        return int(file.read())


class FaultTest(rtf.TestCase):
    def stands(self):
        before = ticks()
        self.sleep(0.15)
        return ticks() == before

    def run(self):
        with self.fault("drop") as lost:
            self.check(self.stands(), "the camera stands")
            lost.remove()
        before = ticks()
        self.wait_until(lambda: ticks() > before, 30, "the camera to run")
        self.fault("drop")
        self.check(self.stands(), "the camera stands again")
        self.fault("drop")
        self.report("not reached")
