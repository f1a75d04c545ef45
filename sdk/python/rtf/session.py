"""Results of a program that `rtf` runs: measurements, samples, files, reports.

A test of another framework, or any program, reports them while it runs::

    import rtf.session

    rtf.session.current().measure("settling time", 0.3, "s", high=0.8)

They belong to the case that runs. A program that `rtf` did not start reports nothing.
"""

from __future__ import annotations

import atexit
import json
import mimetypes
import os

from rtf import _attachment, _location
from rtf._sampling import Sampling, is_within
from rtf.frameworks.connection import Connection

# As `typing.TYPE_CHECKING`, without the time that its import takes.
TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Callable

    Send = Callable[[str, dict[str, object]], None]

_MISSING = object()


class Session:
    """Reports results of the case that runs."""

    def __init__(self, send: Send | None, values: Callable[[], bytes] | None = None) -> None:
        """`send` reports a result, and `values` returns the values of fixtures."""
        self._send = send
        self._values = values
        self._sampling = None if send is None else Sampling(send)
        if self._sampling is not None:
            self._sampling.begin()

    def is_connected(self) -> bool:
        """Whether results are reported to anyone."""
        return self._send is not None

    def measure(
        self,
        name: str,
        value: float,
        unit: str = "",
        low: float | None = None,
        high: float | None = None,
    ) -> bool:
        """Report a measurement, and return whether it is within its limits.

        If it is not, the case fails, but continues.
        """
        fields = {"name": name, "value": float(value), "unit": unit, "low": low, "high": high}
        self._report("measured", {k: v for k, v in fields.items() if v is not None})
        return is_within(value, low, high)

    def sample(  # noqa: PLR0913 - as in a test
        self,
        name: str,
        value: float,
        unit: str = "",
        low: float | None = None,
        high: float | None = None,
        *,
        at: float | None = None,
    ) -> bool:
        """Add a sample of a signal, and return whether it is within its limits.

        `at` is the sample's own time in seconds; without it, the time since the program
        connected to `rtf`. Samples are sent in batches.
        """
        is_good = is_within(value, low, high)
        if self._sampling is not None:
            signal = (name, unit, low, high)
            self._sampling.add(signal, float(value), at, case=None, is_within=is_good)
        return is_good

    def attach(
        self, path: str | os.PathLike[str], name: str = "", media_type: str | None = None
    ) -> None:
        """Add a file to the results; it is copied before this returns."""
        file = os.path.abspath(os.fspath(path))
        _attachment.check(file)
        guessed = media_type or mimetypes.guess_type(file)[0] or "application/octet-stream"
        name = name or os.path.basename(file)
        self._report("attached", {"name": name, "path": file, "media_type": guessed})

    def report(self, text: str) -> None:
        """Add information to the results."""
        self._report("message", {"kind": "report", "text": str(text)})

    def fixture_value(self, name: str, default: object = _MISSING) -> object:
        """Return a value that a fixture of the suite provides, such as `simulator.port`.

        Raises a `LookupError` for an unknown name without a default, in particular if `rtf`
        did not start the program.
        """
        __tracebackhide__ = True  # pytest shows the caller's line
        values: dict[str, object] = {}
        if self._values is not None:
            entries = json.loads(self._values())
            values = {entry["name"]: entry["value"] for entry in entries}
        if name in values:
            return values[name]
        if default is not _MISSING:
            return default
        if self._values is None:
            raise LookupError(f"no value of a fixture is called `{name}`: `rtf` runs no suite")
        known = ", ".join(values) or "none"
        raise LookupError(f"no value of a fixture is called `{name}`; there are: {known}")

    def send_samples(self) -> None:
        """Send the samples that are not sent yet."""
        if self._sampling is not None:
            self._sampling.send()

    def _report(self, method: str, params: dict[str, object]) -> None:
        if self._send is None:
            return
        self.send_samples()
        if method != "attached":
            _location.add_caller(params)
        self._send(method, params)


_current: Session | None = None


def enter(session: Session) -> None:
    """Make this session the present one."""
    global _current  # noqa: PLW0603 - one for the process
    _current = session


def connect(connection: Connection) -> Session:
    """Make a session that reports over this connection the present one."""
    session = Session(connection.request, lambda: connection.ask("fixture-values", {}))
    atexit.register(session.send_samples)
    os.register_at_fork(before=session.send_samples)
    enter(session)
    return session


def current() -> Session:
    """Return the session with the host; one that reports nothing without a host."""
    if _current is None:
        connection = Connection.from_environment()
        if connection is None:
            enter(Session(None))
        else:
            connect(connection)
    assert _current is not None  # noqa: S101 - set above
    return _current
