import rtf


class Near(rtf.TestCase):
    def run(self):
        self.check_near(1.25, 1.0, 0.1, "gain")
        self.check_near([1, 2, 3.5], [1, 2, 3], 0.1, "pose")
        self.check_angle_near(3.1, -3.1, 0.1, "heading")
        self.check_angle_near(0, 1, 0.1, "yaw")
