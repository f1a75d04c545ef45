"""How much of the machine went to others while something was measured.

A ratio with much else going on says little: on two cores a busy one takes away
what lets rtf start the next host ahead.
"""

from __future__ import annotations

import os
import resource
import time
from pathlib import Path

NOISY_SHARE = 0.05
"""From this share of all cores on, a note is due."""

STAT = Path("/proc/stat")


class Others:
    """Watches from its making on."""

    def __init__(self) -> None:
        self.start = (time.monotonic(), busy_seconds(), own_seconds())

    def share(self) -> float:
        """The share of all cores that others have used since; 0 where it cannot be told."""
        then, busy, own = self.start
        elapsed = (time.monotonic() - then) * (os.cpu_count() or 1)
        foreign = (busy_seconds() - busy) - (own_seconds() - own)
        return max(0.0, foreign / elapsed) if elapsed > 0 else 0.0


def busy_seconds() -> float:
    """What all processes have used: the first line of /proc/stat without idle and iowait."""
    if not STAT.exists():
        return 0.0
    fields = STAT.read_text(encoding="ascii").splitlines()[0].split()[1:]
    user, nice, system, _idle, _iowait, irq, softirq, steal = (int(field) for field in fields[:8])
    ticks = user + nice + system + irq + softirq + steal
    return ticks / os.sysconf("SC_CLK_TCK")


def own_seconds() -> float:
    """What this process and all that it has waited for have used."""
    usages = (resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    return sum(usage.ru_utime + usage.ru_stime for usage in usages)
