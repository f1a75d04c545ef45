"""A server of the web page, and its address."""

from __future__ import annotations

import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path


@contextmanager
def served(command: list[str], directory: Path) -> Iterator[tuple[str, str]]:
    """The address and the token of a server that runs within the block."""
    with subprocess.Popen(
        command, cwd=directory, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True
    ) as server:
        assert server.stderr is not None
        try:
            line = server.stderr.readline()
            assert "web: http" in line, "the first line has no address"
            url, _, token = line.removeprefix("web: ").strip().partition("#token=")
            yield url, token
            assert server.poll() is None, f"the server has ended with {server.returncode}"
        finally:
            server.terminate()
