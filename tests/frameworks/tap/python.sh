#!/bin/sh
# tap.py: plan at the end.
cd "$(dirname "$0")" && exec python -B -m tap test_arm.py
