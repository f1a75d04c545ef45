#!/usr/bin/env python3
"""Records tests with the fixture `mcap` and reads the files with the library `mcap`.

    check_fixture_mcap.py RTF

Needs a Python with the library `mcap`.
"""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

from pages import run_fixture_page
from run import expect

TEST = """
import rtf

class Ramp(rtf.TestCase):
    def run(self):
        for step in range(500):
            self.measure("joint 1", step / 512, "rad")
            self.measure("current", 0.5, "A")
            self.sample("wrist", step / 256, "rad", time=step / 100)
        self.report("at the end")
        self.check(self.param != "fails", "the arm follows")
"""

SUITE = """<suite name="arm" parallel="2">
  <fixture param="{param}"> mcap </fixture>
  <test type="python" name="good"> Ramp </test>
  <test type="python" name="bad" param="fails" retries="1"> Ramp </test>
</suite>
"""


def main() -> int:
    """Runs the suite with each setting for keeping recordings."""
    rtf = str(Path(sys.argv[1]).resolve())
    kept = {"": ["bad", "bad"], "--keep always": ["bad", "bad", "good"], "--keep never": []}
    for param, names in kept.items():
        with tempfile.TemporaryDirectory() as directory:
            recorded = run(rtf, Path(directory), param)
            expect(f"recordings with `{param}`", sorted(name for name, _ in recorded), names)
            for _, file in recorded:
                look_into(file)
    with tempfile.TemporaryDirectory() as directory:
        expect("recordings over their limit", run(rtf, Path(directory), "--limit 1k"), [])
        run_fixture_page(rtf, "mcap", Path(directory) / "page")
        left = list(Path(tempfile.gettempdir()).glob("rtf-mcap-*"))
        expect("directories left", left, [])
    return 0


def run(rtf: str, directory: Path, param: str) -> list[tuple[str, Path]]:
    """Runs the suite; returns the tests with a recording, and the files."""
    (directory / "Ramp.py").write_text(TEST)
    (directory / "s.xml").write_text(SUITE.format(param=param))
    ran = subprocess.run(
        [rtf, "run", "s.xml"], cwd=directory, capture_output=True, text=True, check=False
    )
    expect(f"exit code\n{ran.stdout}{ran.stderr}", ran.returncode, 1)
    results = directory / "rtf-results/latest"
    events = [json.loads(line) for line in (results / "events.jsonl").open()]
    collapses = [event for event in events if event["type"] == "fixture-collapsed"]
    expect("collapses", collapses, [])
    names = {event["test"]: event["name"] for event in events if event["type"] == "test-planned"}
    attached = [event for event in events if event["type"] == "attached"]
    return [(names[event["test"]], results / event["attachment"]["path"]) for event in attached]


def look_into(file: Path) -> None:
    """Each channel contains the complete series, in order."""
    from mcap.reader import make_reader  # noqa: PLC0415 - the linters run without it

    series: dict[str, list[Any]] = {}
    times: list[int] = []
    taken: list[int] = []
    with file.open("rb") as stream:
        for _, channel, message in make_reader(stream).iter_messages():
            series.setdefault(channel.topic, []).append(json.loads(message.data))
            times.append(message.log_time)
            if channel.topic == "/wrist":
                taken.append(message.log_time)
    values = [sample["value"] for sample in series["/joint 1"]]
    expect("joint 1 is complete", values == [step / 512 for step in range(500)], True)
    expect("current is complete", series["/current"] == [{"value": 0.5, "unit": "A"}] * 500, True)
    wrist = [{"value": step / 256, "unit": "rad"} for step in range(500)]
    expect("wrist is complete", series["/wrist"] == wrist, True)
    steps = [(at - taken[0]) // 10**6 for at in taken]
    expect("wrist has its own times", steps, [10 * step for step in range(500)])
    expect("log", series["/log"][0], {"kind": "report", "text": "at the end"})
    expect("times in order", times == sorted(times), True)


if __name__ == "__main__":
    sys.exit(main())
