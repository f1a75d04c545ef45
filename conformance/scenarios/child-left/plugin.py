import shutil
import subprocess

import rtf


class ChildLeft(rtf.TestCase):
    def run(self):
        sleep = shutil.which("sleep")
        subprocess.Popen(["rtf-left-behind", "1000"], executable=sleep, start_new_session=True)
        self.report("child started")
