"""Records tests with the fixture `mcap` and reads the files with the library `mcap`."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from checkout import venv
from pages import run_fixture_page
from recordings import messages, packages
from run import Run, expect

pytestmark = pytest.mark.venv("mcap")
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


@pytest.fixture(autouse=True)
def _library(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """The library for this Python; the fixture leaves no directory."""
    monkeypatch.syspath_prepend(packages(venv("mcap")))
    temporary = tmp_path / "tmp"
    temporary.mkdir()
    monkeypatch.setenv("TMPDIR", str(temporary))
    yield
    expect("directories left", list(temporary.glob("rtf-mcap-*")), [])


@pytest.mark.parametrize(
    ("keep", "names"),
    [
        pytest.param("", ["bad", "bad"], id="failed"),
        pytest.param("--keep always", ["bad", "bad", "good"], id="always"),
        pytest.param("--keep never", [], id="never"),
        pytest.param("--limit 1k", [], id="over their limit"),
    ],
)
def test_kept_recordings_are_complete(
    rtf: str, tmp_path: Path, keep: str, names: list[str]
) -> None:
    (tmp_path / "Ramp.py").write_text(TEST)
    (tmp_path / "s.xml").write_text(SUITE.format(param=keep))
    run = Run(rtf, str(tmp_path / "s.xml"), tmp_path / "results")
    expect("exit code", run.wait(), 1)
    expect("collapses", run.reasons(), [])
    attached = list(run.events("attached"))
    expect("recordings", sorted(run.name(event) for event in attached), names)
    for event in attached:
        look_into(run.journal.parent / event["attachment"]["path"])


def test_page(rtf: str, tmp_path: Path) -> None:
    run_fixture_page(rtf, "mcap", tmp_path / "page")


def look_into(file: Path) -> None:
    """Each channel contains the complete series, in order."""
    series: dict[str, list[Any]] = {}
    times: list[int] = []
    taken: list[int] = []
    for _, channel, message in messages(file):
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
