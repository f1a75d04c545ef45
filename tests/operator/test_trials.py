"""Trials of policies in a campaign, with an operator at its terminal."""

import json
import os
import re
import signal
import subprocess
import time
from pathlib import Path

import pytest
from terminal import Terminal

HERE = Path(__file__).resolve().parent
SECONDS = 60.0
SUITE = f'<suite name="fold"><test type="python">{HERE}/outcome.py</test></suite>'
CAMPAIGN = """<campaign suite="fold.xml" episodes="{blocks}" seed="7">
  <parameter name="cloth" distribution="choice" values="towel shirt"/>
  <versions parameter="policy" values="policy-old policy-new" blinded="true"/>
</campaign>"""
LATEST = "rtf-results/campaigns/latest"
ALICE = {"via": "console", "who": "alice"}


class Bench:
    """A directory with a campaign."""

    def __init__(self, rtf: str, directory: Path) -> None:
        """Write the campaign."""
        self.rtf, self.directory = rtf, directory
        (directory / "fold.xml").write_text(SUITE)
        self.write(2)
        self.environment = {k: v for k, v in os.environ.items() if k != "CI"} | {
            "TERM": "xterm",
            "NO_COLOR": "1",
            "HOME": str(directory),
            "LOGNAME": "alice",
        }

    def write(self, blocks: int) -> None:
        """Write the campaign with this number of blocks."""
        (self.directory / "campaign.xml").write_text(CAMPAIGN.format(blocks=blocks))

    def run(self, *arguments: str) -> Terminal:
        """Start a campaign on a terminal."""
        command = [self.rtf, "campaign", "run", *arguments]
        return Terminal(command, self.directory, self.environment, SECONDS)

    def results(self) -> list[str]:
        """The outcomes of all trials that have run."""
        lines = (self.directory / LATEST / "results.jsonl").read_text().splitlines()
        return [json.loads(line)["outcome"] for line in lines]

    def events(self, kind: str) -> list[dict[str, object]]:
        """The events of a kind in the journals of all workers."""
        journals = sorted((self.directory / LATEST / "workers").glob("*/2*/events.jsonl"))
        lines = (line for journal in journals for line in journal.read_text().splitlines())
        return [event for event in map(json.loads, lines) if event["type"] == kind]


@pytest.fixture
def bench(rtf: str, tmp_path: Path) -> Bench:
    """A directory with a campaign."""
    return Bench(rtf, tmp_path)


def answer(session: Terminal, label: str, text: str) -> None:
    """Answer the next question."""
    session.expect(rf"   question  {label}  fold/outcome\n")
    session.expect(rf"answer  {label}> ")
    session.send(f"{text}\n")


def trial(session: Terminal, number: int, outcome: str, of: int = 4) -> None:
    """Answer the questions of a trial."""
    label = f"trial {number} of {of}, block {(number + 1) // 2}"
    answer(session, label, "1")
    answer(session, label, outcome)


def test_a_campaign_is_answered_interrupted_and_resumed_without_betraying_a_version(
    bench: Bench,
) -> None:
    """Ctrl-C in a question; the trial runs again, and the versions are hidden until the end."""
    with bench.run("campaign.xml") as session:
        answer(session, "trial 1 of 4, block 1", "maybe")
        session.expect(r"`maybe` is none of done, cannot, nor a number from 1 to 2")
        session.expect(r"answer  trial 1 of 4, block 1> ")
        session.send("done\n")
        session.expect(r"Did \*\*\* fold it\?")
        session.expect(r"answer  trial 1 of 4, block 1> ")
        session.send("no\n")
        session.expect(r"failed    trial 1 of 4, block 1  cloth=\w+")
        answer(session, "trial 2 of 4, block 1", "done")
        session.expect(r"Did \*\*\* fold it\?")
        session.interrupt()
        assert session.finish() == 128 + signal.SIGINT, session.output
        assert session.has_first_settings(), "the terminal has its settings"
        assert "policy-" not in session.output, session.output
    assert bench.results() == ["failed"], "no half of a trial counts"
    with bench.run("--resume", LATEST) as session:
        for number in (2, 3, 4):
            trial(session, number, "yes")
        assert session.finish() == 0, session.output
        before, _, after = session.output.partition("4 of 4 trials\n")
        assert "policy-" not in before, session.output
        assert re.search(r"of 2 passed .* policy-new$", after, re.M), session.output
    assert bench.results() == ["failed", "passed", "passed", "passed"]
    closed = [event for event in bench.events("question-closed") if "answer" in event]
    assert len(closed) == 9 and all(event["by"] == ALICE for event in closed), closed
    stored = (bench.directory / LATEST).glob("workers/*/2*/*.jsonl")
    assert not any("policy-" in journal.read_text() for journal in stored)


def test_questions_of_two_workers_are_asked_one_after_the_other(bench: Bench) -> None:
    """Each answer reaches the worker whose trial asked."""
    with bench.run("campaign.xml", "--workers", "2") as session:
        asked = []
        for _ in range(8):
            label = session.expect(r"question  (trial (\d) of 4, block \d)")
            # A result of the other worker is followed by the prompt again.
            session.expect(rf"answer  {label[1]}> ")
            asked.append(label[2])
            # Of `done` and `cannot`, or `yes` and `no`: trial 3 fails.
            is_outcome = asked.count(label[2]) == 2
            session.send("2\n" if is_outcome and label[2] == "3" else "1\n")
        assert session.finish() in (0, 1), session.output
    assert sorted(asked) == sorted("12341234"), asked
    assert bench.results() == ["passed", "passed", "failed", "passed"]


def test_workers_end_with_the_campaign_and_questions_with_their_worker(bench: Bench) -> None:
    """SIGKILL for a worker's runner, then for the campaign, while questions are open."""
    with bench.run("campaign.xml") as session:
        session.expect(r"answer  trial 1 of 4, block 1> ")
        os.kill(runner(bench, 1), signal.SIGKILL)
        session.expect(r"error     trial 1 of 4, block 1  cloth=")
        trial(session, 2, "yes")
        session.expect(r"answer  trial 3 of 4, block 2> ")
        worker = runner(bench, 2)
        os.kill(session.pid, signal.SIGKILL)
        session.finish()
    limit = time.monotonic() + SECONDS
    while Path(f"/proc/{worker}").exists() and time.monotonic() < limit:
        time.sleep(0.01)
    assert not Path(f"/proc/{worker}").exists(), "the worker has ended"
    with bench.run("--resume", LATEST) as session:
        for number in (1, 3, 4):
            trial(session, number, "yes")
        assert session.finish() == 0, session.output
    assert bench.results() == ["passed"] * 4


def runner(bench: Bench, worker: int) -> int:
    """The process that runs the tests of a worker: the child of its guard."""
    runs = f"{LATEST}/workers/{worker}/list.jsonl"
    path = str((bench.directory / runs).resolve()).encode()
    for status in Path("/proc").glob("[0-9]*/cmdline"):
        try:
            command = status.read_bytes().split(b"\0")
            stat = (status.parent / "stat").read_text().rpartition(")")[2].split()
            parent = Path(f"/proc/{stat[1]}/cmdline").read_bytes().split(b"\0")
        except OSError:  # it has ended
            continue
        if path in command and path in parent:
            return int(status.parent.name)
    raise AssertionError(f"worker {worker} does not run")


@pytest.mark.parametrize("options", [["--no-input"], []])
def test_without_an_operator_a_trial_is_an_error(bench: Bench, options: list[str]) -> None:
    """As in any run: no operator can answer."""
    bench.write(1)
    command = [bench.rtf, "campaign", "run", "campaign.xml", *options]
    ended = subprocess.run(
        command,
        cwd=bench.directory,
        env=bench.environment,
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        check=False,
    )
    reason = "`--no-input` is set" if options else "standard input has another use"
    assert f"no operator can answer: {reason}" in ended.stdout, ended.stdout
    assert ended.returncode == 6, "undecided: no trial has a result"
