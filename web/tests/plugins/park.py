#!/usr/bin/env python3
"""A hook that does its work."""

print("parked")
