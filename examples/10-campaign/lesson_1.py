"""Lends what lesson 1 has to the scripts of this one."""

from __future__ import annotations

import sys
from pathlib import Path

FOLDER = Path(__file__).resolve().parent.parent / "01-simulated-arm"
sys.path.insert(0, str(FOLDER))
