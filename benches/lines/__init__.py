"""The measurements: one module per group of works that alternate in each round.

A new line is a `Line` in its group; a new group is a module with a function
`group(bench)` and an entry here.
"""

from __future__ import annotations

from measuring.bench import Bench
from measuring.model import Group

from lines import (
    building,
    campaigns,
    clients,
    collapse,
    episodes,
    frameworks,
    history,
    large,
    own_process,
    page,
    python,
    reports,
    signals,
    slurm,
    startup,
    watched,
)

MODULES = (
    own_process,
    python,
    frameworks,
    startup,
    history,
    large,
    reports,
    collapse,
    signals,
    page,
    watched,
    clients,
    campaigns,
    episodes,
    slurm,
    building,
)


def all_groups(bench: Bench) -> list[Group]:
    """Every group, in the order of the table."""
    return [module.group(bench) for module in MODULES]
