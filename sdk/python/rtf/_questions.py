"""Questions to an operator."""

from __future__ import annotations

import itertools
import os

from rtf import _attachment, _location, _session
from rtf._stop import Interrupted

# As `typing.TYPE_CHECKING`, without the time that its import takes.
TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Sequence

ANSWER_SECONDS = 300.0

_PNG = b"\x89PNG\r\n\x1a\n"
_JPEG = b"\xff\xd8\xff"

# Unique in the process: it may serve several tests.
_numbers = itertools.count(1)


def ask(
    text: str, choices: Sequence[str], timeout: float, default: str | None, picture: str | None
) -> str:
    """Ask, and wait for the answer; without one, report an error and end the step."""
    session = _session.current()
    session.require_setup_or_run("questions are allowed in `setup` and `run` of a test only")
    if session.cases.is_forked():
        session.end_with_error("a process that the plug-in forked cannot ask")
    number = next(_numbers)
    params: dict[str, object] = {
        "question": number,
        "text": text,
        "choices": list(choices),
        "timeout_ms": max(0, round(timeout * 1000)),
    }
    if default is not None:
        params["default"] = default
    if picture is not None:
        params["picture"] = _attach(session, picture)
    _location.add_caller(params)
    request = session.request
    request.open_question(number)
    session.notify_in_case("question-asked", params)
    end = request.wait_for_answer(number)
    if end is None:
        raise Interrupted(request.stop_reason)
    answer, problem = end
    if answer is None:
        session.end_with_error(problem)
    return answer


def _attach(session: _session.Session, picture: str) -> str:
    """Attach a picture, and return the path of the copy."""
    full = os.path.abspath(picture)
    _attachment.check(full)
    with open(full, "rb") as file:
        start = file.read(len(_PNG))
    if start == _PNG:
        media_type = "image/png"
    elif start.startswith(_JPEG):
        media_type = "image/jpeg"
    else:
        session.end_with_error(f"the picture `{picture}` is neither PNG nor JPEG")
    return _attachment.attach(session, full, os.path.basename(full), media_type)
