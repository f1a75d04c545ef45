"""Loads a plug-in: a file with one class that derives from a class of the SDK."""

from __future__ import annotations

import os
import sys

from rtf._plugin import Plugin
from rtf.host import predecessor

# As `typing.TYPE_CHECKING`, without the time that its import takes.
TYPE_CHECKING = False
if TYPE_CHECKING:
    from types import CodeType, ModuleType
    from typing import TypeVar

    _P = TypeVar("_P", bound=Plugin)


class LoadError(Exception):
    """The file is no plug-in."""


def load(file: str, base: type[_P]) -> _P:
    """Run the file as the program and create an object of its one class."""
    module = _run_file(file)
    found = _classes(module, base)
    if len(found) == 1:
        return found[0]()
    old = predecessor.find(module)
    if old is not None and not found:
        test = predecessor.PredecessorTest(old())
        if isinstance(test, base):
            return test
    wanted = f"rtf.{base.__name__}"
    if found:
        names = ", ".join(f"`{one.__name__}`" for one in found)
        raise LoadError(f"`{file}` has several classes that derive from {wanted}: {names}")
    others = ", ".join(f"`{one.__name__}`" for one in _classes(module, Plugin))
    hint = f"; it has {others}" if others else ""
    raise LoadError(f"`{file}` has no class that derives from {wanted}{hint}")


def _run_file(file: str) -> ModuleType:
    # `importlib` would create a `__pycache__` next to the user's files, and accepts only
    # file names that are Python identifiers.
    with open(file, "rb", buffering=0) as stream:
        source = stream.read()
    code = _compiled(source, file)
    module = type(sys)(MODULE)
    module.__file__ = file
    predecessor.add_module(module, source)
    forget()
    _host.append(sys.modules["__main__"])
    for name in ("__main__", MODULE):
        sys.modules[name] = module
    directory = os.path.dirname(os.path.abspath(file))
    if sys.path[:1] != [directory]:
        sys.path.insert(0, directory)
    exec(code, module.__dict__)  # noqa: S102 - a host runs the user's file
    return module


# The name that `multiprocessing` gives the program in a process that runs its file again. The
# file is the program here, too, so that such a process finds its functions and classes.
MODULE = "__mp_main__"

# The host's own module, while a plug-in is the program.
_host: list[ModuleType] = []


def forget() -> None:
    """Forget the loaded file: the next one may have the same name."""
    while _host:
        sys.modules["__main__"] = _host.pop()
        sys.modules.pop(MODULE, None)


# The last loaded file: a shared host often loads it again.
_last: list[tuple[str, bytes, CodeType]] = []


def _compiled(source: bytes, file: str) -> CodeType:
    if not _last or _last[0][:2] != (file, source):
        _last[:] = [(file, source, compile(source, file, "exec", dont_inherit=True))]
    return _last[0][2]


def _classes(module: ModuleType, base: type[_P]) -> list[type[_P]]:
    """Find the classes that the file defines and that are no base class of another one."""
    own = {
        entry
        for entry in vars(module).values()
        if isinstance(entry, type)
        and issubclass(entry, base)
        and entry.__module__ == module.__name__
    }
    leaves = [one for one in own if not any(one in other.__mro__[1:] for other in own)]
    return sorted(leaves, key=lambda one: one.__name__)
