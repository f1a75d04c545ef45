import os

import rtf


class Garbage(rtf.TestCase):
    def run(self):
        self.report("before the garbage")
        for name in os.listdir("/proc/self/fd"):
            try:
                is_socket = os.readlink(f"/proc/self/fd/{name}").startswith("socket:")
            except FileNotFoundError:  # the descriptor of the listing itself
                continue
            if is_socket:
                os.write(int(name), b"this is not a message\n")
