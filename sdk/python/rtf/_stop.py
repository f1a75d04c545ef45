"""Exceptions that end a step of a plug-in.

All but `Error` derive from ``BaseException``: an ``except Exception`` around a robot's
driver must not swallow a failed assertion or a stop request. Catching ``BaseException``
does not make a test pass: the problem was recorded before the exception was raised.
"""

from __future__ import annotations


class StepEnded(BaseException):
    """Ends the step; the session has recorded the reason."""


class Error(Exception):
    """Has the same effect as `self.error`, for code without access to `self`.

    Unlike other exceptions, it is reported without its type and without a traceback.
    """


class AssertionEnded(StepEnded):
    """An assertion failed, or the plug-in called ``fail`` or ``error``."""


class CriticalAssertionEnded(AssertionEnded):
    """A critical assertion failed. Ends the test, not only the case."""


class Skipped(StepEnded):
    """The test or the case skips itself."""


class Interrupted(StepEnded):
    """The runner asked the plug-in to stop."""
