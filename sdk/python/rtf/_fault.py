"""Injects faults that the suite declares."""

from __future__ import annotations

from rtf import _session

# As `typing.TYPE_CHECKING`, without the time that its import takes.
TYPE_CHECKING = False
if TYPE_CHECKING:
    from types import TracebackType

_SOCKET = "faults.socket"


class Fault:
    """A fault that the test has injected. It ends with the test at the latest.

    As a context manager, it is removed at the end of the block.
    """

    def __init__(self, name: str) -> None:
        """Inject the fault, and wait until it has begun."""
        self.name = name
        _request("inject", name, f'the fault "{name}" was not injected')

    def remove(self) -> None:
        """Remove the fault. No effect if it has ended already."""
        _request("remove", self.name, f'the fault "{self.name}" was not removed')

    def __enter__(self) -> Fault:
        """Return the fault, which has been injected."""
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        problem: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Remove the fault."""
        self.remove()


def _request(verb: str, name: str, failed: str) -> None:
    """Write a request to the fixture `faults`; a problem is an error of the test."""
    import socket  # noqa: PLC0415 - slow to import, and most tests inject nothing

    session = _session.current()
    session.sampling.send()
    address = session.task.fixture_values.get(_SOCKET)
    problem = "the suite declares no `<fault>` without `at`"
    if address is not None:
        try:
            with socket.socket(socket.AF_UNIX) as connection:
                connection.connect(f"\0{address}")
                connection.sendall(f"{verb}\n{name}\n{session.task.name}\n".encode())
                with connection.makefile() as answer:
                    problem = answer.read()
        except OSError as error:
            problem = f"the fixture `faults` does not answer: {error}"
    if problem:
        session.end_with_error(f"{failed}: {problem}")
