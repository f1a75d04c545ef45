#!/usr/bin/python3
"""Reports nothing."""

import time

time.sleep(1000)
