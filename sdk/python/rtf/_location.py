"""Locations in the plug-in's source."""

from __future__ import annotations

import sys

# As `typing.TYPE_CHECKING`, without the time that its import takes.
TYPE_CHECKING = False
if TYPE_CHECKING:
    from types import FrameType, TracebackType


# In addition to all modules whose names begin with `rtf.`. `runpy` starts the host.
_OURS = frozenset({"rtf", "robottestingframework", "runpy"})


def at(file: str, line: int) -> dict[str, object]:
    """Return a line of a source file as the protocol's `location`; lines count from 1."""
    return {"file": file, "line": line}


def caller() -> dict[str, object] | None:
    """Return the innermost line outside this package: the plug-in's line."""
    frame: FrameType | None = sys._getframe(1)
    while frame is not None:
        if not _is_ours(frame.f_globals):
            return at(frame.f_code.co_filename, frame.f_lineno)
        frame = frame.f_back
    return None


def add_caller(params: dict[str, object]) -> None:
    """Add the plug-in's line to the parameters of a notification, if it is known."""
    place = caller()
    if place is not None:
        params["location"] = place


def of_exception(trace: TracebackType | None, file: str) -> dict[str, object] | None:
    """Return the innermost line of `file` in a traceback, otherwise the innermost line."""
    in_file = None
    last = None
    while trace is not None:
        if not _is_ours(trace.tb_frame.f_globals):
            last = at(trace.tb_frame.f_code.co_filename, trace.tb_lineno)
            if last["file"] == file:
                in_file = last
        trace = trace.tb_next
    return in_file or last


def without_host(trace: TracebackType | None) -> TracebackType | None:
    """Return the traceback from the plug-in's first line on."""
    while trace is not None and _is_ours(trace.tb_frame.f_globals):
        trace = trace.tb_next
    return trace


def _is_ours(names: dict[str, object]) -> bool:
    module = names.get("__name__")
    if module == "__main__":
        # `python3 -m rtf.host` runs under this name.
        return names.get("__package__") == "rtf.host"
    return isinstance(module, str) and (module in _OURS or module.startswith("rtf."))
