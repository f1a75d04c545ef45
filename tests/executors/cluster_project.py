"""A project whose suites run in a cluster."""

from __future__ import annotations

import json
import subprocess
from dataclasses import dataclass
from pathlib import Path

from waiting import equal

TESTS = 12

PASSES = "function TestCase.run() end\n"
FAILS = "function TestCase.run() rtf.fail('it is wrong') end\n"
# Runs until the file `go` exists.
WAITS = """function TestCase.run()
  local started = io.open(os.getenv("RTF_PARAM_DIR") .. "/started", "a")
  started:write(os.getenv("SLURMD_NODENAME") or os.getenv("NODE"), "\\n")
  started:close()
  while not io.open(os.getenv("RTF_PARAM_DIR") .. "/go") do rtf.sleep(0.05) end
end
"""

Verdicts = dict[str, str]


@dataclass
class Executor:
    """Where tests and episodes run."""

    options: list[str]
    environment: dict[str, str] | None = None

    def start(self, command: list[str], directory: Path) -> subprocess.Popen[str]:
        """Starts a command that submits."""
        pipe = subprocess.PIPE
        return subprocess.Popen(
            command, cwd=directory, env=self.environment, text=True, stdout=pipe, stderr=pipe
        )


class Project:
    """A directory with suites, shared by all nodes."""

    def __init__(self, rtf: str, directory: Path, executor: Executor) -> None:
        self.rtf = rtf
        self.executor = executor
        self.dir = directory
        (directory / "passes.lua").write_text(PASSES)
        (directory / "fails.lua").write_text(FAILS)
        (directory / "waits.lua").write_text(WAITS)
        names = [f"T{number}" for number in range(TESTS)]
        kinds = ["fails" if number % 5 == 0 else "passes" for number in range(TESTS)]
        self.suite("arm", dict(zip(names, kinds, strict=True)))
        self.suite("slow", dict.fromkeys("ABCD", "waits"))
        # The only robot of the cluster.
        self.suite("robot", dict.fromkeys("ABCD", "waits"), 'requires="robot"')

    def suite(self, name: str, tests: dict[str, str], attributes: str = "") -> None:
        """Writes a suite with tests by name."""
        lines = "".join(f'<test name="{test}">{kind}.lua</test>' for test, kind in tests.items())
        (self.dir / f"{name}.xml").write_text(f'<suite name="{name}" {attributes}>{lines}</suite>')

    def command(self, *args: str) -> list[str]:
        """The command of a run."""
        return [self.rtf, "run", "--no-history", *args]

    def start(self, *args: str) -> subprocess.Popen[str]:
        """Starts a run with four shards in the cluster."""
        command = self.command(
            *args, *self.executor.options, "--shards", "4", "--shard-by", "count"
        )
        command += ["--set", f"dir={self.dir}"]
        return self.executor.start(command, self.dir)

    def started(self) -> list[str]:
        """The nodes of the tests that have started."""
        path = self.dir / "started"
        return path.read_text().split() if path.exists() else []

    def go(self) -> None:
        """Lets the waiting tests end."""
        (self.dir / "go").touch()

    def submission(self) -> Path:
        """The directory of the only submission."""
        (found,) = (self.dir / "rtf-results/.submissions").iterdir()
        return found


def stored(project: Project) -> Verdicts:
    """The verdicts of the newest run, by the names of the tests."""
    journal = project.dir / "rtf-results/latest/events.jsonl"
    events = [json.loads(line) for line in journal.read_text().splitlines()]
    names = {event["test"]: event["name"] for event in events if event["type"] == "test-planned"}
    finished = [event for event in events if event["type"] == "test-finished"]
    equal(len(finished), len(names))
    return {names[event["test"]]: event["verdict"] for event in finished}
