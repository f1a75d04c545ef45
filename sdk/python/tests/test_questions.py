"""Questions to an operator."""

from __future__ import annotations

from pathlib import Path

import pytest
from driver import Host, arm, plugin, run

QUESTION = "answer = self.ask('Is it closed?', ['yes', 'no'], 60)\nself.report(answer)"


def asking(directory: Path, body: str) -> Host:
    """Start a test."""
    host = Host(directory)
    host.send("run-test", plugin(directory, arm(body)), number=2)
    return host


def test_a_question_returns_its_answer(tmp_path: Path) -> None:
    host = asking(tmp_path, QUESTION)
    asked = host.wait_for("question-asked")
    place = asked.pop("location")
    assert (Path(place["file"]).name, place["line"]) == ("plugin.py", 4)
    assert asked == {
        "question": 1,
        "text": "Is it closed?",
        "choices": ["yes", "no"],
        "timeout_ms": 60000,
    }
    # Of another question, and without a number.
    host.send("question-closed", {"question": 7, "answer": "no"})
    host.send("question-closed", {"answer": "no"})
    host.send("question-closed", {"question": 1, "answer": "yes"})
    assert host.answer()["result"] == {"outcome": "passed"}
    assert host.texts() == [("report", "yes")]
    assert host.end()[0] == 0


def test_no_answer_is_an_error(tmp_path: Path) -> None:
    host = asking(tmp_path, QUESTION)
    host.wait_for("question-asked")
    host.send("question-closed", {"question": 1, "problem": "nobody is there"})
    assert host.answer()["result"] == {"outcome": "error"}
    assert host.texts() == [("error", "nobody is there")]


@pytest.mark.parametrize(("answer", "problem"), [("done", None), ("cannot", "Push it")])
def test_an_instruction_is_done_or_an_error(
    tmp_path: Path, answer: str, problem: str | None
) -> None:
    host = asking(tmp_path, "self.instruct('Push it', timeout=60)")
    assert host.wait_for("question-asked")["choices"] == ["done", "cannot"]
    host.send("question-closed", {"question": 1, "answer": answer})
    host.answer()
    expected = problem and ("error", f"the operator cannot do this: {problem}")
    assert host.problem() == expected


def test_threads_ask_at_the_same_time(tmp_path: Path) -> None:
    body = (
        "from concurrent.futures import ThreadPoolExecutor\n"
        "with ThreadPoolExecutor() as pool:\n"
        "    answers = list(pool.map(lambda text: self.ask(text), 'ab'))\n"
        "self.report(' '.join(answers))"
    )
    host = asking(tmp_path, body)
    asked = [host.wait_for("question-asked") for _ in "ab"]
    for question in reversed(asked):
        end = {"question": question["question"], "answer": f"to {question['text']}"}
        host.send("question-closed", end)
    host.answer()
    assert host.texts() == [("report", "to a to b")]


@pytest.mark.parametrize(
    ("content", "problem"),
    [(b"GIF89a", "is neither PNG nor JPEG"), (b"", "is neither PNG nor JPEG")],
)
def test_a_picture_is_png_or_jpeg(tmp_path: Path, content: bytes, problem: str) -> None:
    (tmp_path / "hand.png").write_bytes(content)
    ran = run(tmp_path, arm("self.ask('?', picture='hand.png')"))
    assert ran.problem == ("error", f"the picture `hand.png` {problem}")
    assert ran.host.of("question-asked") == []


def test_a_picture_is_attached_before_the_question(tmp_path: Path) -> None:
    (tmp_path / "hand.jpg").write_bytes(b"\xff\xd8\xff\xe0 and so on")
    host = Host(tmp_path)
    attachments = tmp_path / "attachments"
    params = plugin(tmp_path, arm("self.ask('?', picture='hand.jpg')"))
    host.send("run-test", {**params, "attachments_dir": str(attachments)}, number=2)
    asked = host.wait_for("question-asked")
    attached = host.of("attached")[0]
    assert attached["media_type"] == "image/jpeg"
    assert asked["picture"] == attached["path"] == str(attachments / "1-hand.jpg")
    host.send("question-closed", {"question": 1, "answer": "yes"})
    assert host.answer()["result"] == {"outcome": "passed"}


def test_a_forked_child_cannot_ask(tmp_path: Path) -> None:
    body = "import os\nchild = os.fork()\nif child == 0:\n    self.ask('?')\nos.waitpid(child, 0)"
    ran = run(tmp_path, arm(body))
    assert ran.problem == ("error", "a process that the plug-in forked cannot ask")
    assert ran.host.of("question-asked") == []
