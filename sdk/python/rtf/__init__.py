"""Write tests and fixtures for the Robot Testing Framework in Python.

A plug-in is a file with one class that derives from :class:`TestCase` or from
:class:`FixtureManager`::

    import rtf

    class Encoders(rtf.TestCase):
        def run(self) -> None:
            position = arm.read(joint=3)
            self.check_near(position, 0.5, 0.01, "joint 3")

``import rtf`` is cheap and does not change the process; the connection to the runner
is in :mod:`rtf.host`.
"""

from rtf._fixture import FixtureManager, Test
from rtf._stop import Error
from rtf._test import TestCase

__all__ = ["Error", "FixtureManager", "Test", "TestCase", "__version__"]

__version__ = "0.1.0"
