"""YARP's network, for plug-ins that open ports without making a `yarp.Network`.

In robot-testing-framework 1.x and 2.x, a fixture in the same process had made one. There is no link
to YARP: its functions are looked up in the library that the plug-in has loaded.
"""

from __future__ import annotations

import os
import re
import sys

# As `typing.TYPE_CHECKING`, without the time that its import takes.
TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Callable

# In YARP 2, the last two letters of the library are capitals.
_LIBRARY = re.compile(rb"^\S+ \S+ \S+ \S+ \S+ +(.*/libYARP_(?:os|OS)\.so[.\d]*)$", re.MULTILINE)

_CLASS = "_ZN4yarp2os11NetworkBase"
_INITIALIZED = f"{_CLASS}11initializedEv"
_INIT = f"{_CLASS}11initMinimumEv"
_FINISH = f"{_CLASS}11finiMinimumEv"

# How a plug-in gets the library: YARP's module, or `ctypes`.
_MODULES = ("yarp", "ctypes")


# What undoes the initialisation of the loaded plug-in.
_finish: list[Callable[[], object]] = []


def init() -> None:
    """Initialise the network, if its library is loaded and the plug-in has not done so."""
    if not any(module in sys.modules for module in _MODULES):
        return
    with open("/proc/self/maps", "rb") as maps:
        found = _LIBRARY.search(maps.read())
    if found is None:
        return
    # Its import takes longer than most tests.
    import ctypes  # noqa: PLC0415

    library = ctypes.CDLL(os.fsdecode(found[1]), mode=os.RTLD_LAZY | os.RTLD_NOLOAD)
    try:
        initialized, start, finish = (library[name] for name in (_INITIALIZED, _INIT, _FINISH))
    except AttributeError:
        return
    initialized.restype = ctypes.c_bool
    if not initialized():
        start()
        _finish.append(finish)


def finish() -> None:
    """Undo the initialisation. A network that the plug-in has made itself stays."""
    while _finish:
        _finish.pop()()
