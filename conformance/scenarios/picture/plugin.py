import rtf


class Picture(rtf.TestCase):
    def run(self):
        self.check_picture("scene", "scene.png", "stored.png", tolerance=0.01)
        self.check_picture("scene", "scene.png", "scene.png", tolerance=0.0)
        self.check_picture("scene", "scene.png", "golden/none.png", tolerance=0.01)
        self.report("the test continues")
