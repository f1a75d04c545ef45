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

# As `typing.TYPE_CHECKING`, without the time that its import takes.
TYPE_CHECKING = False
if TYPE_CHECKING:
    from rtf._episode import Episode
    from rtf._episode_test import EpisodeTest
    from rtf._fixture import FixtureManager, Test
    from rtf._stop import Error
    from rtf._test import TestCase

__all__ = [
    "Episode",
    "EpisodeTest",
    "Error",
    "FixtureManager",
    "Test",
    "TestCase",
    "__version__",
]

__version__ = "0.1.0"

_MODULES = {
    "Episode": "rtf._episode",
    "EpisodeTest": "rtf._episode_test",
    "Error": "rtf._stop",
    "FixtureManager": "rtf._fixture",
    "Test": "rtf._fixture",
    "TestCase": "rtf._test",
}


def __getattr__(name: str) -> object:
    """Import what is used: tests of other frameworks need no base class of plug-ins."""
    module = _MODULES.get(name)
    if module is None:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from importlib import import_module  # noqa: PLC0415 - only when it is used

    value: object = getattr(import_module(module), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    """List the base classes, too, which may not be imported yet."""
    return sorted({*globals(), *_MODULES})
