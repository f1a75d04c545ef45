#!/usr/bin/env python3
"""A hook that succeeds."""

print("parked")
