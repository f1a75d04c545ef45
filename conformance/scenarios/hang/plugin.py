import ctypes

import rtf


class Hang(rtf.TestCase):
    def run(self):
        self.report("going to hang")
        # Locked twice, this never comes back, and the interpreter's lock is held:
        # no line of Python runs any more in this process.
        mutex = ctypes.create_string_buffer(64)
        ctypes.PyDLL(None).pthread_mutex_lock(mutex)
        ctypes.PyDLL(None).pthread_mutex_lock(mutex)
