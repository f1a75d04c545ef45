"""Skips the body of a `with` statement, for which Python has no language feature.

A trace function raises an exception in the frame with the statement, at the instruction
after `__enter__`; `__exit__` swallows it.
"""

from __future__ import annotations

import sys

from rtf._stop import StepEnded

# As `typing.TYPE_CHECKING`, without the time that its import takes.
TYPE_CHECKING = False
if TYPE_CHECKING:
    from types import FrameType


class BodySkipped(StepEnded):
    """Skips the body."""


class BodySkip:
    """Skips the body of the `with` statement whose `__enter__` creates it."""

    def __init__(self) -> None:
        """Trace the frame with the statement instead of a debugger or a coverage tool."""
        frame: FrameType | None = sys._getframe(2)
        while frame is not None and frame.f_globals.get("__name__") == "contextlib":
            # An `ExitStack` enters it: the statement is in the caller's frame.
            frame = frame.f_back
        self._frame = frame
        self._tracer = sys.gettrace()
        if frame is not None:
            self._frame_tracer, self._has_opcodes = frame.f_trace, frame.f_trace_opcodes
            frame.f_trace = self._skip
            # A body on the line of its `with` causes no line event.
            frame.f_trace_opcodes = True
        # A frame is traced only while its thread has a trace function.
        sys.settrace(_ignore_call)

    def restore_tracing(self) -> None:
        """Restore the trace functions; Python removes one that raises an exception."""
        sys.settrace(self._tracer)
        frame, self._frame = self._frame, None
        if frame is not None:
            frame.f_trace, frame.f_trace_opcodes = self._frame_tracer, self._has_opcodes

    def _skip(self, frame: FrameType, event: str, arg: object) -> None:
        del frame, event, arg
        raise BodySkipped


def _ignore_call(frame: FrameType, event: str, arg: object) -> None:
    """Trace no further function."""
    del frame, event, arg
