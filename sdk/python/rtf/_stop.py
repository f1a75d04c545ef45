"""What ends a step of a plug-in early.

These derive from ``BaseException``: an ``except Exception`` around a robot's
driver must not swallow a failed assertion or a request to stop. Whoever
catches ``BaseException`` gains nothing either, since what went wrong first was
recorded before anything was raised.
"""

from __future__ import annotations


class StepEnded(BaseException):
    """The step is over; the session knows why."""


class AssertionEnded(StepEnded):
    """An assertion did not hold, or the plug-in said ``fail`` or ``error``."""


class Interrupted(StepEnded):
    """The runner asked the plug-in to stop."""
