import ctypes

import rtf


class CaseCrash(rtf.TestCase):
    def run(self):
        poses = [f"pose {number}" for number in range(1, 41)]
        self.plan_cases(poses)
        for pose in poses:
            with self.case(pose):
                if pose == "pose 7":
                    ctypes.string_at(0)
