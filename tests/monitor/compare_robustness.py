"""Compares rtf-monitor with rtamt and with a second implementation.

    compare_robustness.py [--seed N] [--count N] PROGRAM reference|dense|discrete

PROGRAM is the example `robustness` of crates/rtf-monitor. Part of test_monitor.py.
"""

from __future__ import annotations

import argparse
import json
import math
import subprocess
import sys

import peer
import reference
from formulas import Choices, Generator, Node, text

TOLERANCE = 1e-9

Traces = dict[str, list[tuple[int, int]]]
Task = tuple[Node, Traces, int]


def run(program: str, tasks: list[Task]) -> list[dict[str, object]]:
    """The answers of the program."""
    lines = [
        json.dumps({"formula": text(formula), "signals": traces, "end": end})
        for formula, traces, end in tasks
    ]
    result = subprocess.run(
        [program], input="\n".join(lines) + "\n", capture_output=True, text=True, check=True
    )
    return [json.loads(line) for line in result.stdout.splitlines()]


def is_equal(one: float | None, other: float | None) -> bool:
    """Whether two robustnesses are equal, apart from rounding."""
    if one is None or other is None:
        return one is None and other is None
    return one == other or abs(one - other) <= TOLERANCE * max(1.0, abs(one))


def number(value: object) -> float | None:
    """A robustness that the program printed."""
    return None if value is None else float(str(value))


def check_reference(program: str, count: int, seed: int) -> int:
    """Linear and held signals, all operators, and the end of the trace."""
    tasks: list[Task] = []
    expected: list[tuple[str | None, float | None]] = []
    for index in range(count):
        steepest = 1 + index % 2
        generator = Generator(seed + index, Choices(rates=True))
        formula = generator.formula(1 + index % 4)
        end = generator.random.randint(0, 9)
        traces = {name: generator.trace(end, steepest) for name in ("x", "y")}
        tasks.append((formula, traces, end))
        judge = reference.Reference(traces, end, reference.grid_of(steepest))
        expected.append(judge.judge(formula))
    return compare("reference", tasks, run(program, tasks), expected)


def check_rtamt(program: str, count: int, seed: int, name: str) -> int:
    """Held signals, with one of the evaluators of rtamt: `dense` or `discrete`."""
    tasks = [peer.make(seed + index, 1 + index % 3) for index in range(count)]
    judge = peer.dense if name == "dense" else peer.discrete
    compared: list[Task] = []
    found = []
    expected: list[tuple[str | None, float | None]] = []
    for task, answer in zip(tasks, run(program, tasks), strict=True):
        formula, traces, _ = task
        robustness = judge(formula, traces)
        if robustness is not None:
            compared.append(task)
            found.append(answer)
            expected.append((None, robustness))
    different = compare(f"rtamt {name}", compared, found, expected)
    if len(compared) < count // 2:
        print(f"rtamt {name}: only {len(compared)} of {count} formulas are comparable")
        different += 1
    return different


def compare(
    name: str,
    tasks: list[Task],
    answers: list[dict[str, object]],
    expected: list[tuple[str | None, float | None]],
) -> int:
    """Prints differences and returns their number."""
    different = 0
    finite = 0
    for (formula, traces, end), answer, (verdict, robustness) in zip(
        tasks, answers, expected, strict=True
    ):
        finite += robustness is not None and math.isfinite(robustness)
        online = answer.get("online")
        results = [answer, online if isinstance(online, dict) else {}]
        if all(
            (verdict is None or result.get("verdict") == verdict)
            and is_equal(number(result.get("robustness")), robustness)
            for result in results
        ):
            continue
        different += 1
        if different <= 5:
            print(f"{name}: {text(formula)}\n  {json.dumps(traces)} until {end}")
            print(f"  expected {verdict} {robustness}, found {json.dumps(answer)}")
    print(f"{name}: {len(tasks)} formulas, {finite} with finite robustness, {different} different")
    return different


def main() -> int:
    """Exits with 1 if a robustness or verdict differs."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--count", type=int, default=1000)
    parser.add_argument("program")
    parser.add_argument("judge", choices=["reference", "dense", "discrete"])
    arguments = parser.parse_args()
    task = (arguments.program, arguments.count, arguments.seed)
    is_reference = arguments.judge == "reference"
    different = check_reference(*task) if is_reference else check_rtamt(*task, arguments.judge)
    return 1 if different else 0


if __name__ == "__main__":
    sys.exit(main())
