# shellcheck shell=bash
# unittest comes with Python.
need_packages python3
