"""Ends a forked host faster than the interpreter does.

The interpreter finalizes all objects. In a fork most of them are the server's, and each
finalized page is copied, which takes longer than everything else in a short test. This
module finalizes only what came after the fork, in Python's order: exit functions, modules
and their contents, buffered output. If anything else might need finalizing (threads,
native code, finalizers), the interpreter ends the process as usual.
"""

from __future__ import annotations

import atexit
import gc
import os
import sys
import threading
import weakref
from types import GeneratorType

# Python's extension modules, which do nothing at the end of a process.
_OWN_DIRECTORY = "lib-dynload"

_STATUS_BYTES = 8192


class ForkExit:
    """The state of a server before it forks."""

    def __init__(self, socket: object) -> None:
        """Record the state that all forks share; `socket` is the server's."""
        self._modules = frozenset(sys.modules)
        self._main = sys.modules["__main__"]
        self._streams = (sys.stdout, sys.stderr)
        self._code_size = _code_size()
        self._is_plain = not has_foreign_code() and not _has_finalizers({id(socket)})

    def end(self, code: int) -> int:
        """End the process, or return the exit code if the interpreter must end it."""
        if code == 0 and self._is_plain and self._finalize():
            os._exit(0)
        # The interpreter finalizes objects in its usual order only if it may collect all of them.
        gc.unfreeze()
        return code

    def _finalize(self) -> bool:
        """Finalize what came after the fork; whether nothing else needs to be finalized."""
        # Calls through `ctypes` may have any effect.
        if threading.active_count() > 1 or "ctypes" in sys.modules:
            return False
        try:
            atexit._run_exitfuncs()
        except BaseException:  # noqa: BLE001 - it was printed, and does not change the exit code
            return False
        self._finalize_modules()
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

    def _finalize_modules(self) -> None:
        """Finalize the new modules, in the interpreter's order."""
        sys.modules["__main__"] = self._main
        new = [name for name in sys.modules if name not in self._modules]
        modules = [weakref.ref(sys.modules.pop(name)) for name in new]
        gc.collect()
        for reference in reversed(modules):
            module = reference()
            if module is not None:
                _clear(vars(module))
        gc.collect()


def _clear(names: dict[str, object]) -> None:
    """Clear a module; names with one underscore first, like the interpreter."""
    for is_private in (True, False):
        for name in list(names):
            if (name[:1] == "_" and name[1:2] != "_") == is_private and name != "__builtins__":
                names[name] = None


def _code_size() -> bytes:
    """Return the size of the loaded libraries."""
    status = os.open("/proc/self/status", os.O_RDONLY | os.O_CLOEXEC)
    try:
        return os.read(status, _STATUS_BYTES).partition(b"VmLib:")[2].partition(b"\n")[0]
    finally:
        os.close(status)


def has_foreign_code() -> bool:
    """Whether an extension module is loaded that is not the interpreter's."""
    files = [getattr(module, "__file__", None) or "" for module in list(sys.modules.values())]
    return any(file.endswith(".so") and _OWN_DIRECTORY not in file.split("/") for file in files)


def _has_finalizers(own: set[int]) -> bool:
    """Whether an object from before the first fork has a finalizer."""
    for stream in (sys.stdin, sys.stdout, sys.stderr):
        own = own | {id(stream), id(stream.buffer), id(getattr(stream.buffer, "raw", None))}
    return any(
        hasattr(type(thing), "__del__") and id(thing) not in own
        for thing in gc.get_objects()
        if not isinstance(thing, GeneratorType)
    )


def _are_finalizers_left() -> bool:
    """Whether an object or a class from after the fork has a finalizer.

    The collector does not track all instances of a class.
    """
    left = gc.get_objects()
    kinds = set(map(type, left))
    if any(issubclass(kind, type) for kind in kinds):
        kinds.update(thing for thing in left if isinstance(thing, type))
    return any(hasattr(kind, "__del__") for kind in kinds)
