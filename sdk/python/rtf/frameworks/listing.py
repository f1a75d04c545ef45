"""Lists cases for the host, without running them.

The host names a file in `RTF_LISTING`. It gets a JSON object per line: a `case`, a `problem`,
and at last `finished`, without which the list is incomplete.
"""

from __future__ import annotations

import json
import os

LISTING_VARIABLE = "RTF_LISTING"


class Listing:
    """Writes the list. The user's modules may print, so it is not standard output."""

    def __init__(self, file: str) -> None:
        """Write to this file."""
        self._stream = open(file, "w", encoding="utf-8", errors="replace")  # noqa: SIM115

    @classmethod
    def from_environment(cls) -> Listing | None:
        """Open the file, and remove the variable. `None` if no list is wanted."""
        file = os.environ.pop(LISTING_VARIABLE, "")
        return cls(file) if file else None

    def case(self, start: dict[str, object]) -> None:
        """Add a case with its `name`, and what is known about it."""
        self._write({"case": start})

    def problem(self, text: str, location: dict[str, object] | None = None) -> None:
        """Add a problem: some cases are not known."""
        self._write({"problem": {"text": text, "location": location}})

    def finish(self) -> None:
        """Complete the list."""
        self._write({"finished": True})
        self._stream.close()

    def _write(self, entry: dict[str, object]) -> None:
        self._stream.write(json.dumps(entry) + "\n")
