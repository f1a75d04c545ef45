"""Answers questions of tests on a pseudo-terminal, as an operator does."""

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
SECONDS = 20.0
# Less than an operator takes: the limit is paused while a question is open.
LIMIT = 2.0
KINDS = ("choice", "text", "instruction", "default", "two", "forever")
# An interrupted question, its tear-down and its reports: far less than its timeout.
QUICK = 15.0


def suite(name: str, kinds: tuple[str, ...] = KINDS, collapses: bool = False) -> str:
    """A suite with a test per kind."""
    test = '<test name="{0}" type="python" timeout="{1:g}s" param="{0}">{2}/questions.py</test>'
    tests = "".join(test.format(kind, LIMIT, HERE) for kind in kinds)
    fixture = '<fixture name="arm" type="process" restarts="0"><command>sleep 3</command></fixture>'
    return f'<suite name="{name}">{fixture if collapses else ""}{tests}</suite>'


class Bench:
    """A directory with suites."""

    def __init__(self, rtf: str, directory: Path) -> None:
        """Write the suites."""
        self.rtf, self.directory = rtf, directory
        (directory / "arm.xml").write_text(suite("arm"))
        (directory / "leg.xml").write_text(suite("leg", ("choice",)))
        (directory / "fragile.xml").write_text(suite("fragile", ("forever",), collapses=True))
        self.environment = {k: v for k, v in os.environ.items() if k != "CI"} | {
            "TERM": "xterm",
            "NO_COLOR": "1",
            "HOME": str(directory),
            "LOGNAME": "alice",
        }

    def run(self, *arguments: str, **environment: str) -> Terminal:
        """Start a run on a terminal."""
        command = [self.rtf, "run", *arguments]
        return Terminal(command, self.directory, self.environment | environment, SECONDS)

    def finish(self, session: Terminal, code: int) -> list[dict[str, object]]:
        """Check the end of a run; return the ends of its questions."""
        assert session.finish() == code, f"exit code {code}\n{session.output}"
        assert session.has_first_settings(), "the terminal has its settings"
        journal = self.directory / "rtf-results" / "latest" / "events.jsonl"
        events = [json.loads(line) for line in journal.read_text().splitlines()]
        self.events = events
        assert events[-1]["type"] == "run-finished", "the journal is complete"
        asked = sum(event["type"] == "question-asked" for event in events)
        closed = [event for event in events if event["type"] == "question-closed"]
        assert asked == len(closed) > 0, f"{asked} questions, {len(closed)} ends"
        return closed


@pytest.fixture
def bench(rtf: str, tmp_path: Path) -> Bench:
    """A directory with suites."""
    return Bench(rtf, tmp_path)


def only(closed: list[dict[str, object]]) -> dict[str, object]:
    """The only question of a run."""
    assert len(closed) == 1, f"one question: {closed}"
    return closed[0]


ALICE = {"via": "console", "who": "alice"}


def test_an_answer_that_is_no_choice_is_explained_and_the_limit_is_paused(bench: Bench) -> None:
    """Answers that are none are explained; the limit of the test is paused."""
    with bench.run("arm.xml::choice") as session:
        session.expect(
            r"   question  arm/choice\n +Is it \\x1b\[2Jclosed\?\n +1 yes, 2 no, within 1 min"
        )
        session.expect(r"answer  arm/choice> ")
        session.send("maybe\n")
        session.expect(r"`maybe` is none of yes, no, nor a number from 1 to 2")
        session.expect(r"answer  arm/choice> ")
        session.send("\n")
        session.expect(r"type an answer; Ctrl-D declines to answer")
        time.sleep(1.5 * LIMIT)
        session.send("1\n")
        session.expect(r"answer  arm/choice: yes \(alice, on the console\)")
        closed = only(bench.finish(session, 0))
        assert closed["answer"] == "yes" and closed["by"] == ALICE, f"{closed}"
        assert "\x1b[2J" not in session.output, "no text clears the screen"


def test_each_report_names_the_question_its_answer_and_who_gave_it(bench: Bench) -> None:
    """Each report names the question, its answer, and who gave it; also of a merged run."""
    with bench.run("arm.xml::instruction") as session:
        session.expect(r"answer  arm/instruction> ")
        session.send("done\n")
        bench.finish(session, 0)
    first = (bench.directory / "rtf-results" / "latest").resolve()
    with bench.run("leg.xml") as session:
        session.expect(r"answer  leg/choice> ")
        session.send("2\n")
        bench.finish(session, 0)
    second = (bench.directory / "rtf-results" / "latest").resolve()
    merge = [bench.rtf, "merge", str(first), str(second)]
    subprocess.run(
        merge, cwd=bench.directory, env=bench.environment, check=True, capture_output=True
    )
    merged = (bench.directory / "rtf-results" / "latest").resolve()
    assert merged not in (first, second), "the merged run is the latest"
    for form, expected in {
        "text": "question: Push the button\n        answer: done (alice, on the console)",
        "junit": 'name="question.Push the button" value="done (alice, on the console)"',
        "markdown": "| <code>arm/instruction</code> | <code>Push the button</code> | "
        "<code>done (alice, on the console)</code> |",
    }.items():
        for run in (first, merged):
            command = [bench.rtf, "report", str(run), "--format", form]
            report = subprocess.run(
                command, env=bench.environment, check=False, capture_output=True, text=True
            )
            assert expected in report.stdout, f"{form}\n{report.stdout}{report.stderr}"
    lines = (merged / "events.jsonl").read_text().splitlines()
    asked = next(e for e in map(json.loads, lines) if e["type"] == "question-asked")
    assert (merged / asked["picture"]).is_file(), f"{asked}"


def test_any_line_answers_a_question_for_text(bench: Bench) -> None:
    """Any line, also with letters of other scripts."""
    with bench.run("arm.xml::text") as session:
        session.expect(r"a line of text, within 1 min")
        session.expect(r"answer  arm/text> ")
        session.send("SN-17 größe\n")
        assert only(bench.finish(session, 0))["answer"] == "SN-17 größe", "the text"


def test_the_path_of_a_picture_is_shown_and_cannot_is_an_error(bench: Bench) -> None:
    """The path of the picture is shown; `cannot` is an error."""
    with bench.run("arm.xml::instruction") as session:
        picture = session.expect(r"^ +picture: (\S+button\.png)$")[1]
        content = (bench.directory / picture).read_bytes()
        assert content.startswith(b"\x89PNG"), picture
        session.expect(r"answer  arm/instruction> ")
        session.send("cannot\n")
        session.expect(r"error: the operator cannot do this: Push the button")
        assert only(bench.finish(session, 1))["answer"] == "cannot", "the answer"


def test_ctrl_d_declines_to_answer(bench: Bench) -> None:
    """Ctrl-D: without a default, that is an error."""
    with bench.run("arm.xml::text") as session:
        session.expect(r"answer  arm/text> ")
        session.send("\x04")
        session.expect(r'no answer to "Serial number\?": declined by alice, on the console')
        closed = only(bench.finish(session, 1))
        assert "answer" not in closed and closed["by"] == ALICE, f"{closed}"


def test_the_default_counts_if_nobody_answers_in_time(bench: Bench) -> None:
    """Nobody answers in time."""
    with bench.run("arm.xml::default") as session:
        session.expect(r"answer  arm/default> ")
        session.expect(r"answer  arm/default: no \(default: no operator answered within 500ms\)")
        closed = only(bench.finish(session, 0))
        assert closed["answer"] == "no" and "by" not in closed, f"{closed}"


def test_a_line_for_an_ended_question_answers_no_other_one(bench: Bench) -> None:
    """What was typed for a question that has ended answers no other one."""
    with bench.run("arm.xml::two") as session:
        session.expect(r"First\?")
        session.expect(r"answer  arm/two> ")
        session.send("yes")
        session.expect(r"Second\?")
        session.expect(r"answer  arm/two> ")
        session.send("\n")
        session.expect(r"type an answer")
        session.send("no\n")
        first, second = bench.finish(session, 0)
        assert (first["answer"], second["answer"]) == ("no", "no"), f"{first} {second}"
        assert "by" not in first and second["by"] == ALICE, f"{first} {second}"


def test_two_questions_are_answered_one_after_the_other(bench: Bench) -> None:
    """Two questions wait: one is answered after the other."""
    with bench.run("-j2", "arm.xml::choice", "leg.xml") as session:
        first = session.expect(r"answer  (arm|leg)/choice> ")[1]
        other = {"arm": "leg", "leg": "arm"}[first]
        session.expect(rf"   question  {other}/choice")
        session.send("yes\n")
        session.expect(rf"answer  {first}/choice: yes")
        session.expect(rf"   question  {other}/choice")
        session.expect(rf"answer  {other}/choice> ")
        session.send("no\n")
        session.expect(rf"answer  {other}/choice: no")
        assert {it["answer"] for it in bench.finish(session, 0)} == {"yes", "no"}, "both"


def test_ctrl_c_ends_the_question_and_the_test_is_torn_down(bench: Bench) -> None:
    """Ctrl-C ends the question at once, and the test is torn down."""
    with bench.run("arm.xml::forever") as session:
        session.expect(r"answer  arm/forever> ")
        start = time.monotonic()
        session.interrupt()
        session.expect(r"answer  arm/forever: not answered: stopped by SIGINT")
        closed = only(bench.finish(session, 130))
        assert time.monotonic() - start < QUICK, f"{time.monotonic() - start} s"
        assert closed["reason"] == "stopped by SIGINT", f"{closed}"
        output = "".join(e["text"] for e in bench.events if e["type"] == "output")
        assert output == "the answer is no longer awaited\ntorn down\n", output


def test_a_collapse_ends_the_question(bench: Bench) -> None:
    """A fixture that collapses ends the question."""
    with bench.run("fragile.xml") as session:
        session.expect(r"answer  fragile/forever> ")
        session.expect(r"answer  fragile/forever: not answered: fixture `arm` collapsed")
        assert "collapsed" in str(only(bench.finish(session, 1))["reason"]), "the reason"


def test_a_run_in_the_background_of_a_shell_asks(bench: Bench) -> None:
    """A run in the background of a shell asks, and is not stopped by the terminal."""
    shell = "set -m; {0} run arm.xml::choice & sleep 3; kill -0 $! && jobs -l; fg >/dev/null"
    command = ["bash", "-c", shell.format(bench.rtf)]
    with Terminal(command, bench.directory, bench.environment, SECONDS) as session:
        session.expect(r"Is it")
        session.expect(r"Running")
        session.send("yes\n")
        session.expect(r"answer  arm/choice: yes \(alice, on the console\)")
        assert only(bench.finish(session, 0))["answer"] == "yes", "the answer"


def test_nobody_is_asked_in_ci_or_without_a_terminal(bench: Bench) -> None:
    """Nobody is asked in CI, with --no-input, without a terminal; defaults count."""
    for arguments, environment, reason in [
        (["--no-input"], {}, "`--no-input` is set"),
        ([], {"CI": "true"}, "the variable `CI` is set, and there is no page (`--web`)"),
        (
            ["--end-with-stdin"],
            {},
            "standard input has another use, and there is no page (`--web`)",
        ),
    ]:
        with bench.run(
            "arm.xml::default", "arm.xml::forever", *arguments, **environment
        ) as session:
            default, forever = bench.finish(session, 1)
            assert default["answer"] == "no", f"{default}"
            for closed in (default, forever):
                assert closed["reason"] == f"no operator can answer: {reason}", f"{closed}"
            assert "answer  arm" not in re.sub(r"answer  arm/\w+: ", "", session.output), (
                "no prompt"
            )
    command = [bench.rtf, "run", "arm.xml::forever"]
    piped = subprocess.run(
        command,
        cwd=bench.directory,
        env=bench.environment,
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        timeout=QUICK,
        check=False,
    )
    assert piped.returncode == 1, piped.stdout
    assert "no operator can answer: standard input is no terminal" in piped.stdout, piped.stdout


def test_the_terminal_is_usable_after_the_runner_was_killed(bench: Bench) -> None:
    """The guard ends a run whose runner dies while a question waits; the terminal is usable."""
    with bench.run("arm.xml::forever") as session:
        session.expect(r"answer  arm/forever> ")
        children = Path(f"/proc/{session.pid}/task/{session.pid}/children").read_text().split()
        os.kill(int(children[0]), signal.SIGKILL)
        session.expect(r"the runner died")
        assert session.finish() == 5, session.output
        assert session.has_first_settings(), "the terminal has its settings"
