"""Judges formulas with rtamt.

Both of its evaluators hold each sample until the next one. What differs from spec/monitors.md is
not compared:

- In discrete time, the first condition of `until` and `since` need not hold at the time of the
  second one, and a window may reach beyond the end of the trace.
- In dense time, the robustness of `since` has no value where it is -inf at the start.
"""

from __future__ import annotations

import rtamt
from formulas import Choices, Generator, Node, horizon, reach, text

Trace = list[tuple[int, int]]

DENSE = Choices(
    leaves=("hold",),
    functions=("abs", "negative"),
    edges=False,
    differences=True,
    open_intervals=False,
)


def operators(node: Node) -> set[str]:
    """The operators of a formula."""
    return {node.operator}.union(*(operators(part) for part in node.parts))


def is_cut(node: Node) -> bool:
    """Whether an unbounded operator judges windows at the end of the trace."""
    is_unbounded = node.operator in ("always", "eventually") and node.interval is None
    inner = max((horizon(part) for part in node.parts), default=0)
    return (is_unbounded and inner > 0) or any(is_cut(part) for part in node.parts)


def make(seed: int, depth: int) -> tuple[Node, dict[str, Trace], int]:
    """A formula and traces whose last values last until each window is complete."""
    generator = Generator(seed, DENSE)
    formula = generator.formula(depth)
    changes = generator.random.randint(0, 9)
    end = changes + 2 * (horizon(formula) + reach(formula)) + 1
    traces = {}
    for name in DENSE.signals:
        samples = dict(generator.trace(changes, 2, gaps=False))
        last = samples[max(samples)]
        traces[name] = [(time, samples.get(time, last)) for time in range(end + 1)]
    return formula, traces, end


def dense(formula: Node, traces: dict[str, Trace]) -> float | None:
    """The robustness at the start, in dense time; `None` if it has no value there."""
    specification = rtamt.StlDenseTimeSpecification()
    for name in traces:
        specification.declare_var(name, "float")
    specification.spec = text(formula, rtamt=True)
    specification.parse()
    samples = [[name, [list(map(float, sample)) for sample in traces[name]]] for name in traces]
    result = specification.evaluate(*samples)
    return float(result[0][1]) if result[0][0] == 0 else None


def discrete(formula: Node, traces: dict[str, Trace]) -> float | None:
    """The robustness at the start, in discrete time; `None` if it is not comparable."""
    if operators(formula) & {"until", "since"} or is_cut(formula):
        return None
    specification = rtamt.StlDiscreteTimeSpecification()
    for name in traces:
        specification.declare_var(name, "float")
    specification.spec = text(formula, rtamt=True)
    specification.parse()
    samples: dict[str, list[float]] = {"time": [time for time, _ in traces["x"]]}
    for name, trace in traces.items():
        samples[name] = [float(value) for _, value in trace]
    return float(specification.evaluate(samples)[0][1])
