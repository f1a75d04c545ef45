"""A Python package of a workspace."""

SPEED = 3
