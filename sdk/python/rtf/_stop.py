"""What ends a step of a plug-in early.

All but `Error` derive from ``BaseException``: an ``except Exception`` around a
robot's driver must not swallow a failed assertion or a request to stop. Whoever
catches ``BaseException`` gains nothing either, since what went wrong first was
recorded before anything was raised.
"""

from __future__ import annotations


class StepEnded(BaseException):
    """The step is over; the session knows why."""


class Error(Exception):
    """Raised by a plug-in's code, or by its modules: what `self.error` is, with this text.

    Unlike other exceptions it is told without its type and without a traceback.
    """


class AssertionEnded(StepEnded):
    """An assertion did not hold, or the plug-in said ``fail`` or ``error``."""


class Interrupted(StepEnded):
    """The runner asked the plug-in to stop."""
