"""Forks a process that is its maker's sibling: a child of the runner.

With `os.fork` it takes a second fork to get there. `clone3` does it in one, and
what the two other parties of a fork have to do is called by name: Python's own
steps, and those of the GNU C library in a process of one thread. Where one of
them cannot be called, there is no such clone.
"""

from __future__ import annotations

import os
import socket
import sys

from rtf.host.fork_exit import has_foreign_code

# As `typing.TYPE_CHECKING`, without the time that its import takes.
TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

# On all machines alike, as for all system calls since Linux 5.1.
_CLONE3 = 435
_CLONE_PARENT = 0x8000
_CLONE_CHILD_CLEARTID = 0x200000
_CLONE_CHILD_SETTID = 0x1000000

# The numbers of `set_robust_list` and `get_robust_list`, which are older.
_ROBUST_LISTS = {"x86_64": (273, 274), "aarch64": (99, 100), "riscv64": (99, 100)}

_GET_TID_ADDRESS = 40

# Modules whose libraries may want to be told of a fork.
_TOLD = {"_hashlib", "_ssl", "_tkinter"}


class Clone:
    """What the C library and Python are called by."""

    def __init__(self) -> None:
        """Find it; some error when there is not all."""
        import ctypes  # noqa: PLC0415 - not every interpreter has it

        self._c: Any = ctypes.PyDLL(None, use_errno=True)
        self._errno = ctypes.get_errno
        self._before: Any = ctypes.pythonapi.PyOS_BeforeFork
        self._after: Any = ctypes.pythonapi.PyOS_AfterFork_Parent
        self._after_in_child: Any = ctypes.pythonapi.PyOS_AfterFork_Child
        for step in (self._before, self._after, self._after_in_child):
            step.restype = None
        self._c.syscall.restype = ctypes.c_long
        if not (os.confstr("CS_GNU_LIBC_VERSION") or "").startswith("glibc"):
            raise OSError("another C library keeps other things")
        self._set, get = _ROBUST_LISTS[os.uname().machine]
        self._list, self._size = ctypes.c_void_p(), ctypes.c_size_t()
        tid = ctypes.c_void_p()
        self._call(get, 0, ctypes.byref(self._list), ctypes.byref(self._size))
        if self._c.prctl(_GET_TID_ADDRESS, ctypes.byref(tid), 0, 0, 0) != 0:
            raise OSError(self._errno(), "the kernel does not tell where the thread's id is")
        flags = _CLONE_PARENT | _CLONE_CHILD_SETTID | _CLONE_CHILD_CLEARTID
        # flags, pidfd, child_tid, parent_tid, exit_signal, stack, stack_size, tls
        values = (flags, 0, tid.value or 0, 0, 0, 0, 0, 0)
        self._arguments = (ctypes.c_uint64 * len(values))(*values)
        self._bytes = ctypes.c_size_t(ctypes.sizeof(self._arguments))
        # A plug-in that needs them imports them as in any process.
        for name in [name for name in sys.modules if name.lstrip("_").startswith("ctypes")]:
            del sys.modules[name]

    @classmethod
    def prepare(cls, runner: socket.socket) -> Clone | None:
        """Find what is needed; `None` where a clone would not be the runner's, or not whole."""
        peer = runner.getsockopt(socket.SOL_SOCKET, socket.SO_PEERCRED, 12)
        if int.from_bytes(peer[:4], sys.byteorder) != os.getppid():
            return None
        if has_foreign_code() or _TOLD & set(sys.modules):
            return None
        try:
            return cls()
        except (AttributeError, ImportError, KeyError, OSError, ValueError):
            return None

    def fork(self) -> int:
        """Make the process, and return its number; 0 in that process."""
        self._before()
        pid = int(self._c.syscall(_CLONE3, self._arguments, self._bytes))
        if pid == 0:
            self._c.syscall(self._set, self._list, self._size)
            self._after_in_child()
            return 0
        problem = self._errno()
        self._after()
        if pid < 0:
            raise OSError(problem, os.strerror(problem))
        return pid

    def _call(self, number: int, *arguments: object) -> None:
        if self._c.syscall(number, *arguments) != 0:
            raise OSError(self._errno(), os.strerror(self._errno()))
