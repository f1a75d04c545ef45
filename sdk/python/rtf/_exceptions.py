"""Reports an exception of the plug-in."""

from __future__ import annotations

from rtf import _location
from rtf._stop import Error

# As `typing.TYPE_CHECKING`, without the time that its import takes.
TYPE_CHECKING = False
if TYPE_CHECKING:
    from rtf._session import Session


def report(session: Session, problem: BaseException) -> None:
    """Report an exception as an error, with its type, text, location and traceback.

    An `rtf.Error` is reported by its text alone.
    """
    text, place = described(problem, session.task.file)
    session.error(text, location=place)


def described(problem: BaseException, file: str) -> tuple[str, dict[str, object] | None]:
    """Return the text about an exception, and its line in the plug-in `file`."""
    place = _location.of_exception(problem.__traceback__, file)
    if isinstance(problem, Error):
        return str(problem), place
    import traceback  # noqa: PLC0415 - slow to import, and most tests raise nothing

    reason = "".join(traceback.format_exception_only(type(problem), problem)).strip()
    if isinstance(problem, SyntaxError):
        reason = f"{type(problem).__name__}: {problem.msg}"
        place = _location.at(problem.filename or file, problem.lineno or 0)
    trace = _location.without_host(problem.__traceback__)
    lines = traceback.format_exception(type(problem), problem, trace)
    text = f"{reason}\n{''.join(lines).rstrip()}" if trace else reason
    # The plug-in's own classes go by their names, as those of a program.
    return text.replace("__mp_main__.", ""), place
