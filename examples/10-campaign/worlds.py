"""Runs worlds one at a time: asks `rtf campaign search`."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path
from typing import Any

FOLDER = Path(__file__).resolve().parent


class Worlds:
    """The worlds of a campaign. The simulator stays up between them."""

    def __init__(self, campaign: str, *options: str) -> None:
        self._rtf = subprocess.Popen(
            ["rtf", "campaign", "search", campaign, *options],
            cwd=FOLDER,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        self.parameters: list[dict[str, Any]] = self._read()["parameters"]

    def run(self, seed: int | None = None, **parameters: float | str) -> dict[str, Any]:
        """Runs one world; parameters that are not named are nominal."""
        question: dict[str, Any] = {"parameters": parameters}
        if seed is not None:
            question["seed"] = seed
        assert self._rtf.stdin
        print(json.dumps(question), file=self._rtf.stdin, flush=True)
        answer = self._read()
        if answer.get("outcome") not in ("passed", "failed"):
            raise RuntimeError(f"no result: {answer}")
        return answer

    def _read(self) -> dict[str, Any]:
        assert self._rtf.stdout
        line = self._rtf.stdout.readline()
        if not line:
            raise RuntimeError(f"rtf ended with exit code {self._rtf.wait()}")
        answer: dict[str, Any] = json.loads(line)
        return answer

    def close(self) -> None:
        """Ends `rtf`, which tears down when its standard input is closed."""
        assert self._rtf.stdin
        assert self._rtf.stdout
        self._rtf.stdin.close()
        self._rtf.wait()
        self._rtf.stdout.close()
