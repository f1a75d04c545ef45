"""Messages, measurements, samples and attachments."""

from __future__ import annotations

import json
import math
import os
from pathlib import Path
from typing import Any

import pytest
from driver import arm, run


@pytest.mark.parametrize(
    ("call", "text"),
    [
        ("check_near(1.25, 1.0, 0.1, 'gain')", "gain: got 1.25, expected 1 ± 0.1 (off by 0.25)"),
        ("check_near([1, 2, 3.5], (1, 2, 3), 0.1, 'pose')",
         "pose: got 3.5, expected 3 ± 0.1 (off by 0.5) at index 2"),
        ("check_near(Array([[1, 2], [3, 9]]), Array([[1, 2], [3, 4]]), 0.1, 'pose')",
         "pose: got 9, expected 4 ± 0.1 (off by 5) at index 3"),
        ("check_near([1, 2], [1, 2, 3], 0.1, 'pose')", "pose: got 2 values, expected 3"),
        ("check_near(float('nan'), 1, 0.1, 'gain')", "gain: got nan, expected 1 ± 0.1"),
        ("check_near([0, float('inf')], [5, float('inf')], 9, 'gain')",
         "gain: got inf, expected inf ± 9 at index 1"),
        ("check_angle_near(0, 1, 0.1, 'yaw')", "yaw: got 0, expected 1 ± 0.1 (off by 1)"),
        ("check_angle_near([0, 6.5], [0, 0], 0.1, 'yaw')",
         "yaw: got 6.5, expected 0 ± 0.1 (off by 0.216815) at index 1"),
    ],
)  # fmt: skip
def test_a_failed_comparison_has_its_numbers(tmp_path: Path, call: str, text: str) -> None:
    array = (
        "class Array:\n"
        "    def __init__(self, rows): self.rows = rows\n"
        "    def tolist(self): return self.rows\n"
    )
    ran = run(tmp_path, array + arm(f"self.{call}"))
    assert ran.texts == [("failure", text)]
    assert ran.result == {"outcome": "failed"}


def test_a_comparison_that_holds_is_a_check_with_its_numbers(tmp_path: Path) -> None:
    ran = run(tmp_path, arm("self.check_angle_near(3.1, -3.1, 0.1, 'heading')"))
    (message,) = ran.host.of("message")
    assert (message["kind"], message["text"]) == ("check", "heading")
    assert message["comparison"] == {"expected": [-3.1], "got": [3.1], "tolerance": 0.1}


def test_a_vector_names_its_worst_element_and_carries_no_nan(tmp_path: Path) -> None:
    ran = run(tmp_path, arm("self.check_near([1, float('nan')], [1, 2], 0.1, 'pose')"))
    comparison = ran.host.of("message")[0]["comparison"]
    assert comparison == {"expected": [1, 2], "got": [1, None], "tolerance": 0.1, "worst": 1}


@pytest.mark.parametrize(
    "call",
    ["check_near('1', 1, 0.1, 'x')", "check_near(1, 1, -1, 'x')", "measure('x', 1, '', math.nan)"],
)
def test_wrong_use_is_an_error(tmp_path: Path, call: str) -> None:
    ran = run(tmp_path, "import math\n" + arm(f"self.{call}"))
    assert ran.result is not None
    assert ran.result["outcome"] == "error"


def test_a_measurement_has_a_place_unit_and_limits(tmp_path: Path) -> None:
    ran = run(tmp_path, arm("self.report(self.measure('error', 0.02, 'rad', None, 0.05))"))
    assert ran.texts == [("report", "True")]
    assert ran.host.of("measured") == [
        {
            "name": "error",
            "value": 0.02,
            "unit": "rad",
            "high": 0.05,
            "location": {"file": str(tmp_path / "plugin.py"), "line": 4},
        }
    ]


def test_a_measurement_that_is_not_finite_fails_and_is_sent_as_null(tmp_path: Path) -> None:
    ran = run(tmp_path, arm("self.measure('rate', float('nan'), 'Hz', 95)"))
    assert ran.host.of("measured")[0]["value"] is None
    assert ran.result == {"outcome": "failed"}


def test_a_message_names_the_line_of_the_plugin_also_from_a_helper(tmp_path: Path) -> None:
    helper = "def helper(test):\n    test.check(True, 'in a helper')\n"
    ran = run(tmp_path, helper + arm("helper(self)\nself.report('here')"))
    lines = [message["location"]["line"] for message in ran.host.of("message")]
    assert lines == [3, 7]


@pytest.mark.parametrize(
    ("source", "length"), [("'50% ä 🤖\\nsecond line'", 19), ("'x' * 17 * 1024 * 1024", 17 << 20)]
)
def test_text_is_never_cut(tmp_path: Path, source: str, length: int) -> None:
    ran = run(tmp_path, arm(f"self.report({source})"))
    text = "".join(part for _, part in ran.texts)
    assert len(text) == length
    assert set(text) in ({"x"}, set("50% ä 🤖\nsecond line"))
    assert ran.result == {"outcome": "passed"}


def test_invalid_unicode_does_not_break_the_channel(tmp_path: Path) -> None:
    ran = run(tmp_path, arm(r"self.report('a\udcffb')"))
    assert ran.texts == [("report", "a?b")]


def test_a_file_is_attached_by_its_full_path(tmp_path: Path) -> None:
    (tmp_path / "trace.csv").write_text("t,q\n0,1\n")
    ran = run(tmp_path, arm("self.attach('trace.csv', media_type='text/csv')"))
    expected = {
        "name": "trace.csv",
        "path": str(tmp_path / "trace.csv"),
        "media_type": "text/csv",
    }
    assert ran.host.of("attached") == [expected]


def test_attachments_that_belong_together_are_in_a_directory(tmp_path: Path) -> None:
    for name in ("a.mcap", "metadata.yaml"):
        (tmp_path / name).write_text(name)
    names = ["bag/a.mcap", "bag/metadata.yaml", "bag/a.mcap", "../../..//x/../y", ".."]
    body = "\n".join(f"self.attach('a.mcap', {name!r})" for name in names)
    kept = tmp_path / "kept"
    ran = run(tmp_path, arm(body), attachments_dir=str(kept))
    paths = [os.path.relpath(one["path"], kept) for one in ran.host.of("attached")]
    assert paths == [
        "1-bag/a.mcap",
        "1-bag/metadata.yaml",
        "2-bag/a.mcap",
        "1-x/y.mcap",
        "1-...mcap",
    ]


def test_an_attachment_without_an_extension_gets_that_of_its_file(tmp_path: Path) -> None:
    (tmp_path / "plot.png").write_text("x")
    body = "self.attach('plot.png', 'arm 3')\nself.attach('plot.png', 'run.txt')"
    ran = run(tmp_path, arm(body), attachments_dir=str(tmp_path / "kept"))
    attached = ran.host.of("attached")
    names = [os.path.basename(one["path"]) for one in attached]
    assert names == ["1-arm_3.png", "1-run.txt"]
    assert attached[0]["name"] == "arm 3"


def test_a_missing_file_is_an_error(tmp_path: Path) -> None:
    ran = run(tmp_path, arm("self.attach('trace.csv')"))
    assert ran.texts[0][1].startswith("FileNotFoundError: there is no file `")


def test_only_files_can_be_attached(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    cases = [("pipe", "a FIFO"), (".", "a directory"), ("/dev/null", "a device or a socket")]
    for path, kind in cases:
        ran = run(tmp_path, arm(f"self.attach('{path}')"))
        assert ran.problem is not None
        assert ran.problem[1].endswith(f"cannot be attached: it is {kind}, not a file")


def test_a_plugin_knows_its_name_parameters_and_repetition(tmp_path: Path) -> None:
    body = (
        "self.report([self.name, self.param, self.environment, self.repetition,\n"
        "             self.interrupted(), self.args])"
    )
    setup = "    def setup(self, args):\n        self.args = args\n"
    more: dict[str, Any] = {"param": "--rate 100", "environment": "--robot sim", "repetition": 3}
    ran = run(tmp_path, arm(body, setup), **more)
    expected = ["Arm", "--rate 100", "--robot sim", 3, False, ["--rate", "100"]]
    assert ran.texts == [("report", str(expected))]


def test_wait_until_names_what_it_waited_for_and_the_last_value(tmp_path: Path) -> None:
    body = "self.position = 0.5\nself.wait_until(lambda: None, 0.05, 'the door to open')"
    ran = run(tmp_path, arm(body + "\nself.report('never')"))
    text = "the door to open: not within 0.05 s (last value: None)"
    assert ran.texts == [("failure", text)]


def test_wait_until_asks_before_it_sleeps_and_returns_true(tmp_path: Path) -> None:
    ran = run(tmp_path, arm("self.report(self.wait_until(lambda: 7, 0, 'nothing'))"))
    assert ran.texts == [("report", "True")]


def test_messages_from_threads_do_not_mix(tmp_path: Path) -> None:
    body = (
        "import threading\n"
        "def tell(): [self.report('x' * 5000) for _ in range(50)]\n"
        "threads = [threading.Thread(target=tell) for _ in range(8)]\n"
        "[thread.start() for thread in threads]\n"
        "[thread.join() for thread in threads]"
    )
    ran = run(tmp_path, arm(body))
    assert ran.texts == [("report", "x" * 5000)] * 400


def test_angles_differ_by_less_than_half_a_turn() -> None:
    from rtf._near import Comparison

    far = Comparison(math.pi * 3, 0.0, math.pi * 1.01, angle=True)
    assert far.problem() is None


def test_samples_come_in_batches_and_before_later_messages(tmp_path: Path) -> None:
    ran = run(tmp_path, arm(
        "for step in range(600): self.sample('speed', step, 'm/s', low=0, time=step / 100)\n"
        "self.report('r')\n"
        "self.sample('speed', -1, 'm/s', low=0, time=7)\n"
        "self.sample('speed', float('nan'), time=8)"
    ))  # fmt: skip
    assert ran.result == {"outcome": "failed"}
    batches = ran.host.of("sampled")
    assert all(len(batch["points"]) <= 256 for batch in batches)
    points = [point for batch in batches for point in batch["points"]]
    assert points == [*([step / 100, step] for step in range(600)), [7, -1], [8, None]]
    line = {"file": str(tmp_path / "plugin.py"), "line": 4}
    assert batches[0] == {
        "name": "speed", "unit": "m/s", "low": 0, "location": line, "points": batches[0]["points"],
    }  # fmt: skip
    methods = [message["method"] for message in ran.host.seen if "method" in message]
    assert methods[:2] == ["phase", "phase"]
    assert methods[2:-3] == ["sampled"] * (len(batches) - 2) + ["message"]


def test_samples_are_sent_before_a_wait_and_a_fork(tmp_path: Path) -> None:
    ran = run(tmp_path, "import os\n" + arm(
        "self.sample('speed', 1)\n"
        "if os.fork() == 0: os._exit(0)\n"
        "self.sample('speed', 2)\n"
        "self.sleep(0.2)\n"
        "os._exit(3)"
    ))  # fmt: skip
    assert [batch["points"][0][1] for batch in ran.host.of("sampled")] == [1, 2]


def test_sampling_at_a_rate_keeps_its_deadlines(tmp_path: Path) -> None:
    ran = run(tmp_path, "import time\n" + arm(
        "start, due = time.monotonic(), []\n"
        "def read():\n"
        "    due.append((time.monotonic() - start) * 100)\n"
        "    if len(due) == 3: time.sleep(0.035)\n"
        "    return len(due)\n"
        "good = self.sample_for('speed', 0.2, 100, read, high=1000)\n"
        "self.check(good and time.monotonic() - start >= 0.2, 'took its time')\n"
        "self.check(all(at >= tick for tick, at in enumerate(due)), f'none is early: {due}')\n"
        "self.check(due[3] >= 5 and len(due) <= 18, f'what was missed is left out: {due}')"
    ))  # fmt: skip
    assert ran.result == {"outcome": "passed"}, ran.texts
    points = [point for batch in ran.host.of("sampled") for point in batch["points"]]
    assert [value for _, value in points] == list(range(1, len(points) + 1))
    assert all(a[0] < b[0] for a, b in zip(points, points[1:]))


def test_texts_are_those_of_all_sdks() -> None:
    from rtf import _text
    from rtf._near import Comparison

    file = Path(__file__).resolve().parents[3] / "conformance" / "texts.json"
    vectors = json.loads(file.read_text(encoding="utf-8"))
    for value, text in vectors["numbers"]:
        assert _text.number(float(value)) == text
    for case in vectors["comparisons"]:
        comparison = Comparison(
            _values(case["got"]), _values(case["expected"]), case["tolerance"], angle=case["angle"]
        )
        assert comparison.problem() == case["problem"], case


def _values(numbers: Any) -> Any:
    """Return numbers of the vectors: those that JSON does not have are strings."""
    return [float(one) for one in numbers] if isinstance(numbers, list) else float(numbers)
