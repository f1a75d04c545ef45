"""A second, slow implementation of the semantics in spec/monitors.md.

Time is a grid that is so fine that each kink of each function is on it: samples and intervals are
full seconds, values are integers, so the slopes are integers, and lines cross at fractions with
known denominators. At each time of the grid, a function has three values: its limit from the left,
its value, and its limit from the right. All values in a row are a sequence in which extrema over
windows are those of slices. Numbers are integers: multiples of 1/grid.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from dataclasses import dataclass

from formulas import Node, horizon

INFINITY = math.inf

Values = list[float]
Trace = list[tuple[int, int]]


def grid_of(steepest: int) -> int:
    """The steps per second for slopes up to `steepest`, when differences of slopes divide."""
    return math.lcm(*range(1, 2 * steepest + 1)) * steepest


@dataclass
class Mode:
    """`sign` 0: complete windows only. Otherwise the bound in this direction."""

    sign: int
    is_truth: bool


class Reference:
    """Judges formulas on one trace, which starts at 0 and ends at `end`."""

    def __init__(self, traces: dict[str, Trace], end: int, grid: int) -> None:
        self.traces = traces
        self.end = end
        self.grid = grid

    def judge(self, formula: Node) -> tuple[str, float | None]:
        """The verdict and the robustness."""
        bounds = {}
        for is_truth in (False, True):
            for sign in (-1, 1):
                function = Evaluation(self, Mode(sign, is_truth)).function(formula, 1)
                bounds[is_truth, sign] = function[1]
        judged: dict[bool, float | None] = {False: None, True: None}
        if horizon(formula) <= self.end:
            for is_truth in (False, True):
                judged[is_truth] = Evaluation(self, Mode(0, is_truth)).function(formula, 1)[1]
        truth, margin = judged[True], judged[False]
        if bounds[True, 1] < 0:
            verdict, decided = "Violated", bounds[False, 1]
        elif bounds[True, -1] > 0:
            verdict, decided = "Holds", bounds[False, -1]
        elif truth is None:
            return "NotEnoughData", None
        else:
            verdict, decided = ("Violated" if truth < 0 else "Holds"), 0.0
        if margin is not None:
            decided = max(bounds[False, -1], min(bounds[False, 1], margin))
        return verdict, decided / self.grid


class Evaluation:
    """The functions of a formula with one mode: sequences from time 0 on."""

    def __init__(self, reference: Reference, mode: Mode) -> None:
        self.reference = reference
        self.grid = reference.grid
        self.mode = mode

    def unknown(self, polarity: int) -> float:
        return self.mode.sign * polarity * INFINITY

    def length(self, end: float) -> int:
        """The length of a sequence up to a time in seconds: without the last limit."""
        return 3 * round(end * self.grid) + 2

    def function(self, node: Node, polarity: int, end: float = 0) -> Values:
        """The sequence from 0 to `end` in seconds; it may be longer."""
        evaluate = {
            "not": self.negation,
            "and": self.junction,
            "or": self.junction,
            "->": self.junction,
            "rise": self.edge,
            "fall": self.edge,
            "always": self.future,
            "eventually": self.future,
            "historically": self.past,
            "once": self.past,
            "until": self.until,
            "since": self.since,
        }.get(node.operator, self.comparison)
        return evaluate(node, polarity, end)

    def negation(self, node: Node, polarity: int, end: float) -> Values:
        return [-value for value in self.function(node.parts[0], -polarity, end)]

    def junction(self, node: Node, polarity: int, end: float) -> Values:
        sign = -1 if node.operator == "->" else 1
        first = self.function(node.parts[0], sign * polarity, end)
        second = self.function(node.parts[1], polarity, end)
        pick = min if node.operator == "and" else max
        return [pick(sign * one, other) for one, other in zip(first, second, strict=False)]

    def steps(self, seconds: int) -> int:
        return 3 * seconds * self.grid

    def operand_end(self, node: Node, end: float) -> float:
        """The last time that an operator of the future sees."""
        _, high = node.interval or (0, None)
        if high is not None:
            return end + high
        if self.mode.sign == 0:
            return self.reference.end - max(horizon(part) for part in node.parts)
        return self.reference.end

    def future(self, node: Node, polarity: int, end: float) -> Values:
        low, high = node.interval or (0, None)
        last = self.operand_end(node, end)
        inner = self.function(node.parts[0], polarity, last)[: self.length(last)]
        pick = max if node.operator == "eventually" else min
        result = []
        for place in range(self.length(end)):
            first = place + self.steps(low)
            window = inner[first : None if high is None else place + self.steps(high) + 1]
            result.append(pick(window) if window else self.unknown(polarity))
        return result

    def past(self, node: Node, polarity: int, end: float) -> Values:
        low, high = node.interval or (0, None)
        inner = self.function(node.parts[0], polarity, end)
        pick, empty = (max, -INFINITY) if node.operator == "once" else (min, INFINITY)
        result = []
        for place in range(self.length(end)):
            first = 1 if high is None else max(1, place - self.steps(high))
            window = inner[first : max(0, place - self.steps(low) + 1)]
            result.append(pick(window) if window else empty)
        return result

    def until(self, node: Node, polarity: int, end: float) -> Values:
        low, high = node.interval or (0, None)
        last = self.operand_end(node, end)
        length = self.length(last)
        condition = self.function(node.parts[0], polarity, last)[:length]
        goal = self.function(node.parts[1], polarity, last)[:length]
        result = []
        for place in range(self.length(end)):
            first = place + self.steps(low)
            stop = length if high is None else min(length, place + self.steps(high) + 1)
            value = -INFINITY
            least = min(condition[place : min(first, length)], default=INFINITY)
            if first >= length:
                value = min(least, self.unknown(polarity))
            for at in range(first, stop):
                least = min(least, condition[at])
                if least <= value:
                    break
                value = max(value, min(least, goal[at]))
            result.append(value)
        return result

    def since(self, node: Node, polarity: int, end: float) -> Values:
        low, high = node.interval or (0, None)
        condition = self.function(node.parts[0], polarity, end)
        goal = self.function(node.parts[1], polarity, end)
        result = []
        for place in range(self.length(end)):
            last = place - self.steps(low)
            first = 1 if high is None else max(1, place - self.steps(high))
            value = -INFINITY
            least = min(condition[max(1, last + 1) : place + 1], default=INFINITY)
            for at in range(last, first - 1, -1):
                least = min(least, condition[at])
                if least <= value:
                    break
                value = max(value, min(least, goal[at]))
            result.append(value)
        return result

    def edge(self, node: Node, polarity: int, end: float) -> Values:
        """At an edge, the condition is false directly before and true directly after it."""
        truth = Evaluation(self.reference, Mode(self.mode.sign, True))
        sign = 1 if node.operator == "rise" else -1
        # One step more, for the limit from the right at the end.
        after = truth.function(node.parts[0], polarity * sign, end + 1 / self.grid)
        before = truth.function(node.parts[0], -polarity * sign, end)
        # A held value is known directly after the last sample.
        is_held = not self.operators(node.parts[0]) & {"signal", "rate"}
        last = self.length(self.reference.end) - 1
        if is_held and last + 1 < len(after):
            after[last + 1] = after[last]
        result = []
        for place in range(self.length(end)):
            if place == last + 1:
                after[place] = truth.unknown(polarity * sign) if self.mode.sign else after[last]
            at = place - place % 3
            is_point = place % 3 == 1
            late = after[at + 2] if is_point else after[place]
            early = before[at] if is_point else before[place]
            result.append(min(sign * late, -sign * early))
            if place < 2:
                result[place] = -INFINITY
        return result

    def comparison(self, node: Node, polarity: int, end: float) -> Values:
        left, right = (self.number(part) for part in node.parts)
        known = self.length(self.reference.end)
        margins = []
        for one, other in zip(left[:known], right[:known], strict=True):
            match node.operator:
                case "<" | "<=":
                    margin = other - one
                case ">" | ">=":
                    margin = one - other
                case "==":
                    margin = -abs(one - other)
                case _:
                    margin = abs(one - other)
            margins.append(margin)
        is_rate = "rate" in self.operators(node)
        if self.mode.is_truth:
            margins = self.truth(margins, node.operator in ("<=", ">=", "=="))
        if is_rate:
            # The slope is known up to the next sample.
            margins[-1] = self.unknown(polarity) if self.mode.sign else margins[-2]
        missing = self.length(end) + 3 - len(margins)
        value = self.unknown(polarity) if self.mode.sign else margins[-1]
        return margins + [value] * max(0, missing)

    def operators(self, node: Node) -> set[str]:
        return {node.operator}.union(*(self.operators(part) for part in node.parts))

    def truth(self, margins: Values, holds_at_zero: bool) -> Values:
        """Limits that are 0 have the sign of the line next to them."""
        result = []
        for place in range(len(margins)):
            # The other end of the line that a limit belongs to.
            other = {0: place - 1, 1: place, 2: place + 1}[place % 3]
            is_limit = place % 3 != 1 and 0 <= other < len(margins)
            margin = margins[other if margins[place] == 0 and is_limit else place]
            is_true = margin > 0 or (margin == 0 and holds_at_zero)
            result.append(INFINITY if is_true else -INFINITY)
        return result

    def number(self, node: Node) -> Values:
        """The sequence up to the end of the trace."""
        parts = [self.number(part) for part in node.parts]
        operator = node.operator
        if operator == "constant":
            return [float(str(node.leaf)) * self.grid] * self.length(self.reference.end)
        if operator in ("signal", "hold"):
            return self.signal(str(node.leaf), operator == "hold")
        if operator == "rate":
            return self.rate(parts[0])
        functions: dict[str, Callable[..., float]] = {
            "negative": lambda value: -value,
            "abs": abs,
            "min": min,
            "max": max,
            "+": lambda one, other: one + other,
            "-": lambda one, other: one - other,
        }
        return [functions[operator](*values) for values in zip(*parts, strict=True)]

    def signal(self, name: str, is_held: bool) -> Values:
        samples = list(self.reference.traces[name])
        if samples[-1][0] < self.reference.end:
            samples.append((self.reference.end, samples[-1][1]))
        values: Values = [samples[0][1] * self.grid] * 2
        for (start, one), (end, other) in itertools.pairwise(samples):
            steps = (end - start) * self.grid
            values.append(one * self.grid)
            for step in range(1, steps + 1):
                value: float = one * self.grid
                if not is_held:
                    rise = (other - one) * self.grid * step
                    assert rise % steps == 0 or steps > self.grid
                    value += rise / steps if rise % steps else rise // steps
                at = other * self.grid if step == steps else value
                values.extend([value, at] + ([at] if step < steps else []))
        return values

    def rate(self, values: Values) -> Values:
        """The slopes of a function that is linear between full seconds."""
        steps = range(2, len(values) - 2, 3)
        slopes = [(values[place + 1] - values[place]) * self.grid for place in steps]
        if not slopes:
            return [0.0] * len(values)
        result = [slopes[0]] * 2
        for slope, after in zip(slopes, [*slopes[1:], slopes[-1]], strict=True):
            result += [slope, slope, after]
        return result
