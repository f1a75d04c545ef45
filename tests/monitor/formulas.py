"""Random formulas as trees, and their texts for rtf and rtamt."""

from __future__ import annotations

import random
from dataclasses import dataclass, field

COMPARISONS = ("<", "<=", ">", ">=", "==", "!=")


@dataclass
class Node:
    """A part of a formula: an operator, its operands, and the interval of a temporal operator."""

    operator: str
    parts: list[Node] = field(default_factory=list)
    interval: tuple[int, int | None] | None = None
    # The name of a signal or a constant.
    leaf: str | int | None = None


def text(node: Node, rtamt: bool = False) -> str:
    """The text, with seconds as the unit of intervals."""
    parts = [text(part, rtamt) for part in node.parts]
    operator = node.operator
    interval = ""
    if node.interval is not None:
        low, high = node.interval
        interval = f"[{low},{'inf' if high is None else high}]"
    if operator in ("signal", "constant") or (operator == "hold" and rtamt):
        result = str(node.leaf)
    elif operator == "hold":
        result = f"hold({node.leaf})"
    elif operator in ("abs", "min", "max", "rate", "rise", "fall"):
        result = f"{operator}({', '.join(parts)})"
    elif operator == "negative":
        result = f"(0 - {parts[0]})" if rtamt else f"(-{parts[0]})"
    elif len(parts) == 1:
        result = f"({operator}{interval} ({parts[0]}))"
    else:
        sign = "!==" if rtamt and operator == "!=" else operator
        result = f"({parts[0]} {sign}{interval} {parts[1]})"
    return result


def horizon(node: Node) -> int:
    """How much of the future a judgement needs at least, in seconds."""
    inner = max((horizon(part) for part in node.parts), default=0)
    if node.operator in ("always", "eventually", "until"):
        low, high = node.interval or (0, None)
        return inner + (low if high is None else high)
    return inner


def reach(node: Node) -> int:
    """How much of the past its bounded operators see, in seconds."""
    inner = max((reach(part) for part in node.parts), default=0)
    if node.operator in ("historically", "once", "since") and node.interval is not None:
        low, high = node.interval
        return inner + (low if high is None else high)
    return inner


@dataclass
class Choices:
    """What a random formula may contain."""

    signals: tuple[str, ...] = ("x", "y")
    leaves: tuple[str, ...] = ("signal", "hold")
    functions: tuple[str, ...] = ("abs", "min", "max", "negative")
    comparisons: tuple[str, ...] = COMPARISONS
    edges: bool = True
    differences: bool = False
    rates: bool = False
    constants: tuple[int, int] = (-1, 2)
    longest: int = 3
    unbounded: bool = True
    open_intervals: bool = True


class Generator:
    """Makes formulas from a seed."""

    def __init__(self, seed: int, choices: Choices) -> None:
        self.random = random.Random(seed)
        self.choices = choices

    def number(self, depth: int) -> Node:
        draw = self.random
        if depth > 0 and self.choices.functions and draw.random() < 0.3:
            function = draw.choice(self.choices.functions)
            count = 2 if function in ("min", "max") else 1
            return Node(function, [self.number(depth - 1) for _ in range(count)])
        if self.choices.differences and draw.random() < 0.2:
            return Node(draw.choice("+-"), [self.leaf(), self.leaf()])
        if self.choices.rates and draw.random() < 0.2:
            return Node("rate", [Node("signal", leaf=draw.choice(self.choices.signals))])
        return self.leaf()

    def leaf(self) -> Node:
        kind = self.random.choice(self.choices.leaves)
        return Node(kind, leaf=self.random.choice(self.choices.signals))

    def comparison(self) -> Node:
        constant = Node("constant", leaf=self.random.randint(*self.choices.constants))
        return Node(self.random.choice(self.choices.comparisons), [self.number(1), constant])

    def interval(self) -> tuple[int, int | None] | None:
        draw = self.random
        low = draw.choice((0, 0, draw.randint(0, self.choices.longest)))
        high = low + draw.randint(0, self.choices.longest)
        if self.choices.unbounded and draw.random() < 0.25:
            return (low, None) if self.choices.open_intervals and draw.random() < 0.5 else None
        return (low, high)

    def formula(self, depth: int) -> Node:
        draw = self.random
        if depth == 0:
            return self.comparison()
        kind = draw.random()
        if kind < 0.1:
            return Node("not", [self.formula(depth - 1)])
        if kind < 0.4:
            operator = draw.choice(("and", "or", "->"))
            return Node(operator, [self.formula(depth - 1), self.formula(depth - 1)])
        if kind < 0.45 and self.choices.edges:
            return Node(draw.choice(("rise", "fall")), [self.comparison()])
        if kind < 0.8:
            operator = draw.choice(("always", "eventually", "historically", "once"))
            return Node(operator, [self.formula(depth - 1)], self.interval())
        operator = draw.choice(("until", "since"))
        operands = [self.formula(depth - 1), self.formula(depth - 1)]
        return Node(operator, operands, self.interval())

    def trace(self, end: int, steepest: int, gaps: bool = True) -> list[tuple[int, int]]:
        """Samples at full seconds from 0 on, with integer slopes."""
        draw = self.random
        samples = [(0, draw.randint(-2, 2))]
        while samples[-1][0] < end:
            time, value = samples[-1]
            step = draw.choice((1, 1, 2, 3)) if gaps else 1
            value += step * draw.randint(-steepest, steepest)
            samples.append((time + step, max(-3 * step, min(3 * step, value))))
            if (samples[-1][1] - samples[-2][1]) % step or abs(
                samples[-1][1] - samples[-2][1]
            ) > steepest * step:
                samples[-1] = (time + step, samples[-2][1])
        return [sample for sample in samples if sample[0] <= end]
