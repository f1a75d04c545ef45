#!/usr/bin/python3
"""Dies before it reports anything."""

import os
import signal
import time

# roslaunch calls a process that has died at once one that failed to launch.
time.sleep(0.5)
os.kill(os.getpid(), signal.SIGSEGV)
