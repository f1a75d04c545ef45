"""Ends a forked host without taking down what its server had made.

An interpreter that ends takes down all that it has, piece by piece. In a fork
most of that is its server's, and to touch it is to copy it: that took longer
than anything else in a short test. Nobody can notice it either. What came
since the fork, the plug-in's above all, ends here as Python ends it: exit
functions, then modules and what they hold, then what is still to be written.
Whenever there is more than that, the interpreter ends the long way.
"""

from __future__ import annotations

import atexit
import gc
import os
import sys
import threading
import weakref
from types import GeneratorType

# Python's own modules in machine code, which do nothing at the end of a process.
_OWN_FOLDER = "lib-dynload"

_STATUS_BYTES = 8192


class Ending:
    """What a server knows of itself before it forks."""

    def __init__(self, socket: object) -> None:
        """Look at what all forks have in common; the socket is the server's."""
        self._modules = frozenset(sys.modules)
        self._streams = (sys.stdout, sys.stderr)
        self._code_size = _code_size()
        self._is_plain = not has_foreign_code() and not _has_finalizers({id(socket)})

    def end(self, code: int) -> int:
        """End the process, unless that is the interpreter's to do: then return the exit code."""
        if code == 0 and self._is_plain and self._take_down():
            os._exit(0)
        return code

    def _take_down(self) -> bool:
        """Whether nothing is left whose end anybody could notice."""
        # What was called by `ctypes` may have left anything.
        if threading.active_count() > 1 or "ctypes" in sys.modules:
            return False
        try:
            atexit._run_exitfuncs()
        except BaseException:  # noqa: BLE001 - it was printed, and changes no exit code
            return False
        self._end_modules()
        if threading.active_count() > 1 or _code_size() != self._code_size:
            return False
        if (sys.stdout, sys.stderr) != self._streams or _are_finalizers_left():
            return False
        try:
            for stream in self._streams:
                stream.flush()
        except (OSError, ValueError):
            return False
        return True

    def _end_modules(self) -> None:
        """Take down the modules that came, in the interpreter's order."""
        came = [name for name in sys.modules if name not in self._modules]
        modules = [weakref.ref(sys.modules.pop(name)) for name in came]
        gc.collect()
        for reference in reversed(modules):
            module = reference()
            if module is not None:
                _clear(vars(module))
        gc.collect()


def _clear(names: dict[str, object]) -> None:
    """Let go of what a module holds; names with one underscore are the first to go."""
    for is_private in (True, False):
        for name in list(names):
            if (name[:1] == "_" and name[1:2] != "_") == is_private and name != "__builtins__":
                names[name] = None


def _code_size() -> bytes:
    """How much machine code the process has: more, when a library was loaded."""
    status = os.open("/proc/self/status", os.O_RDONLY | os.O_CLOEXEC)
    try:
        return os.read(status, _STATUS_BYTES).partition(b"VmLib:")[2].partition(b"\n")[0]
    finally:
        os.close(status)


def has_foreign_code() -> bool:
    """Whether there is a module in machine code that did not come with the interpreter."""
    files = [getattr(module, "__file__", None) or "" for module in list(sys.modules.values())]
    return any(file.endswith(".so") and _OWN_FOLDER not in file.split("/") for file in files)


def _has_finalizers(own: set[int]) -> bool:
    """Whether something that was made before the first fork does something at its end."""
    for stream in (sys.stdin, sys.stdout, sys.stderr):
        own = own | {id(stream), id(stream.buffer), id(getattr(stream.buffer, "raw", None))}
    return any(
        hasattr(type(thing), "__del__") and id(thing) not in own
        for thing in gc.get_objects()
        if not isinstance(thing, GeneratorType)
    )


def _are_finalizers_left() -> bool:
    """Whether something that came since the fork, and is still there, does something at its end.

    A class is enough: the collector does not know of all that is made from one.
    """
    left = gc.get_objects()
    kinds = set(map(type, left))
    if any(issubclass(kind, type) for kind in kinds):
        kinds.update(thing for thing in left if isinstance(thing, type))
    return any(hasattr(kind, "__del__") for kind in kinds)
