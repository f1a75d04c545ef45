"""A program on a pseudo-terminal, as a user runs it in a window."""

import os
import pty
import re
import select
import signal
import termios
import time
from pathlib import Path
from types import TracebackType

SECONDS = 120.0
"""How long a session waits for a text, by default."""


def _keep_output_at_signals() -> None:
    """Otherwise, the kernel drops output that follows a typed Ctrl-C."""
    settings = termios.tcgetattr(0)
    settings[3] |= termios.NOFLSH
    termios.tcsetattr(0, termios.TCSANOW, settings)


def _default_signals() -> None:
    """Otherwise, those of the keyboard are ignored if a script runs this in the background."""
    for number in (signal.SIGHUP, signal.SIGINT, signal.SIGQUIT):
        signal.signal(number, signal.SIG_DFL)


class Terminal:
    """A session on a pseudo-terminal, whose leader is the program."""

    def __init__(
        self,
        command: list[str],
        directory: Path,
        environment: dict[str, str],
        seconds: float = SECONDS,
    ) -> None:
        """Start the program."""
        self.output = ""
        self._seconds = seconds
        self._position = 0
        self._status: int | None = None
        self.pid, self._terminal = pty.fork()
        if self.pid == 0:
            _keep_output_at_signals()
            _default_signals()
            os.chdir(directory)
            os.execvpe(command[0], command, environment)
        while not (settings := termios.tcgetattr(self._terminal))[3] & termios.NOFLSH:
            time.sleep(0.001)
        self._settings = settings

    def __enter__(self) -> "Terminal":
        """Return the session."""
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """End the program if it is still there."""
        if self._status is None:
            os.kill(self.pid, signal.SIGTERM)
            self._wait(time.monotonic() + self._seconds)
        os.close(self._terminal)

    def expect(self, pattern: str) -> re.Match[str]:
        """Wait until the program has printed this after the last match."""
        limit = time.monotonic() + self._seconds
        while not (match := re.compile(pattern, re.M).search(self.output, self._position)):
            self._require(self._read(limit), f"`{pattern}` was not printed")
        self._position = match.end()
        return match

    def send(self, text: str) -> None:
        """Type a text."""
        os.write(self._terminal, text.encode())

    def interrupt(self) -> None:
        """Press Ctrl-C."""
        self.send("\x03")

    def foreground(self) -> int:
        """Return the process group in the foreground."""
        return os.tcgetpgrp(self._terminal)

    def has_first_settings(self) -> bool:
        """Whether the settings of the terminal are those of its start."""
        return termios.tcgetattr(self._terminal) == self._settings

    def finish(self) -> int:
        """Wait for the end of the program; return its exit code."""
        limit = time.monotonic() + self._seconds
        while self._read(limit):
            pass
        return self._wait(limit)

    def _wait(self, limit: float) -> int:
        while self._status is None and time.monotonic() < limit:
            pid, status = os.waitpid(self.pid, os.WNOHANG)
            if pid:
                self._status = os.waitstatus_to_exitcode(status)
            else:
                time.sleep(0.01)
        if self._status is None:
            os.kill(self.pid, signal.SIGKILL)
            raise AssertionError(f"it did not end\n{self.output}")
        return self._status

    def _read(self, limit: float) -> bool:
        """Read what the program prints; false at its end."""
        ready, _, _ = select.select([self._terminal], [], [], max(0.0, limit - time.monotonic()))
        self._require(bool(ready), "nothing more was printed in time")
        try:
            data = os.read(self._terminal, 65536)
        except OSError:  # the last process has closed the terminal
            return False
        if b"\x1b[6n" in data:  # where is the cursor?
            self.send("\x1b[1;1R")
        self.output += data.decode(errors="replace").replace("\r\n", "\n")
        return bool(data)

    def _require(self, holds: bool, text: str) -> None:
        if not holds:
            raise AssertionError(f"{text}\n{self.output}")
