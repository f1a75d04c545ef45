"""Measures how much of the processors other programs used during a measurement.

Ratios are unreliable on a busy machine: rtf starts hosts ahead on the second core.
"""

from __future__ import annotations

import os
import resource
import time
from pathlib import Path

NOISY_SHARE = 0.05
"""The share of all cores above which a note is printed."""

STAT = Path("/proc/stat")


class Others:
    """Measures from its creation on."""

    def __init__(self) -> None:
        self.start = (time.monotonic(), busy_seconds(), own_seconds())

    def share(self) -> float:
        """The share of all cores that others have used since; 0 if it is unknown."""
        then, busy, own = self.start
        elapsed = (time.monotonic() - then) * (os.cpu_count() or 1)
        foreign = (busy_seconds() - busy) - (own_seconds() - own)
        return max(0.0, foreign / elapsed) if elapsed > 0 else 0.0


def busy_seconds() -> float:
    """The time of all processes: the first line of /proc/stat without idle and iowait."""
    if not STAT.exists():
        return 0.0
    fields = STAT.read_text(encoding="ascii").splitlines()[0].split()[1:]
    user, nice, system, _idle, _iowait, irq, softirq, steal = (int(field) for field in fields[:8])
    ticks = user + nice + system + irq + softirq + steal
    return ticks / os.sysconf("SC_CLK_TCK")


def own_seconds() -> float:
    """The time of this process and its descendants that have ended."""
    usages = (resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    return sum(usage.ru_utime + usage.ru_stime for usage in usages)
