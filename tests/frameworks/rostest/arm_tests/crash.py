#!/usr/bin/python3
"""Dies before it reports anything."""

import os
import signal

os.kill(os.getpid(), signal.SIGSEGV)
