"""Comparisons of two versions with SciPy, for `oracle.py`."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from scipy import stats

CONFIDENCE = 0.95


def results() -> dict[str, list[Any]]:
    """The rows of each kind."""
    return {
        "fisher": fisher(),
        "difference": difference(),
        "paired_difference": paired_difference(),
        "paired_means": paired_means(),
        "means": means(),
        "holm": holm(),
        "paired_power": paired_power(),
        "independent_power": independent_power(),
    }


SAMPLES = [(7, 10, 3, 10), (0, 20, 5, 18), (45, 50, 40, 50), (180, 200, 95, 100)]
SAMPLES += [(20, 20, 20, 20), (0, 12, 9, 9), (880, 1000, 920, 1000)]
"""Successes and trials of both versions."""


def fisher() -> list[list[float]]:
    """Successes and trials of both, twice the smaller p value of one side."""
    return [[*sample, fisher_p(*sample)] for sample in SAMPLES]


def fisher_p(first: int, trials: int, second: int, others: int) -> float:
    """The two-sided p value."""
    table = [[first, trials - first], [second, others - second]]
    sides = [stats.fisher_exact(table, side).pvalue for side in ("less", "greater")]
    return min(1.0, 2 * float(min(sides)))


def wilson(successes: int, trials: int) -> tuple[float, float, float]:
    """A rate with its interval."""
    interval = stats.binomtest(successes, trials).proportion_ci(CONFIDENCE, "wilson")
    return successes / trials, float(interval.low), float(interval.high)


def difference() -> list[list[float]]:
    """Successes and trials of both, the ends of Newcombe's interval."""
    return [[*sample, *newcombe(sample[:2], sample[2:], 0.0)] for sample in SAMPLES]


def newcombe(
    first: tuple[int, ...], second: tuple[int, ...], correlation: float
) -> tuple[float, float]:
    """The ends of the interval of the second rate minus the first one."""
    (p, low, high), (q, other_low, other_high) = wilson(*first), wilson(*second)
    cross = np.array([[1.0, -correlation], [-correlation, 1.0]])
    ends = []
    for sign, distances in ((-1, (q - other_low, high - p)), (1, (other_high - q, p - low))):
        vector = np.array(distances)
        ends.append(q - p + sign * math.sqrt(max(0.0, float(vector @ cross @ vector))))
    return ends[0], ends[1]


def paired_difference() -> list[list[float]]:
    """Passed by both, by the first one, the second one, none; the ends of Newcombe's interval."""
    rows = []
    for pairs in ((1, 1, 7, 12), (17, 10, 0, 3), (20, 2, 3, 25), (0, 5, 9, 0), (30, 0, 0, 0)):
        both, first, second, none = pairs
        count = sum(pairs)
        table = np.array([[both, first], [second, none]], dtype=float)
        product = float(np.linalg.det(table))
        margins = float(np.prod([*table.sum(axis=0), *table.sum(axis=1)]))
        corrected = product if product <= 0 else max(0.0, product - count / 2)
        correlation = corrected / math.sqrt(margins) if margins > 0 else 0.0
        ends = newcombe((both + first, count), (both + second, count), correlation)
        rows.append([*pairs, *ends])
    return rows


def paired_means() -> list[list[Any]]:
    """Differences, the ends of Student's interval."""
    rng = np.random.default_rng(20262)
    rows = []
    for count in (2, 5, 40):
        values = np.round(rng.normal(0.3, 1.0, size=count), 3)
        interval = stats.ttest_1samp(values, 0.0).confidence_interval(CONFIDENCE)
        rows.append([values.tolist(), float(interval.low), float(interval.high)])
    return rows


def means() -> list[list[Any]]:
    """Values of both, the ends of Welch's interval, the p value of all permutations."""
    rng = np.random.default_rng(20263)
    rows = []
    for count, others in ((2, 3), (5, 7), (8, 8)):
        first = np.round(rng.normal(0.0, 1.0, size=count), 3)
        second = np.round(rng.normal(0.8, 2.0, size=others), 3)
        interval = stats.ttest_ind(second, first, equal_var=False).confidence_interval(CONFIDENCE)
        test = stats.permutation_test((first, second), square_of_t, n_resamples=np.inf)
        p_value = divisions_as_large(first, second, test.null_distribution, test.statistic)
        ends = float(interval.low), float(interval.high)
        rows.append([first.tolist(), second.tolist(), *ends, p_value])
    return rows


def square_of_t(first: np.ndarray[Any, Any], second: np.ndarray[Any, Any]) -> float:
    """The square of Welch's t."""
    return float(stats.ttest_ind(first, second, equal_var=False).statistic ** 2)


def divisions_as_large(
    first: np.ndarray[Any, Any],
    second: np.ndarray[Any, Any],
    divisions: np.ndarray[Any, Any],
    observed: float,
) -> float:
    """The share of all divisions with a statistic that is not smaller."""
    assert len(divisions) == math.comb(len(first) + len(second), len(first))
    return float(np.mean(divisions >= observed * (1 - 1e-9)))


def holm() -> list[list[list[float]]]:
    """P values, the adjusted ones."""
    rows = []
    for values in ([0.01, 0.04, 0.03, 0.005], [0.5, 0.9], [0.02], [0.01, 0.01, 0.01, 0.2, 0.02]):
        order = np.argsort(values, kind="stable")
        scaled = np.sort(values) * np.arange(len(values), 0, -1)
        adjusted = np.empty(len(values))
        adjusted[order] = np.minimum(1.0, np.maximum.accumulate(scaled))
        rows.append([values, adjusted.tolist()])
    return rows


def paired_power() -> list[list[float]]:
    """Pairs, probabilities that only the better and only the worse one passes, alpha, power."""
    cases = [(30, 0.3, 0.1, 0.05), (60, 0.2, 0.02, 0.05), (40, 0.25, 0.0, 0.01)]
    return [[*case, power_of_pairs(*case)] for case in cases]


def power_of_pairs(pairs: int, better: float, worse: float, alpha: float) -> float:
    """The probability of all tables with which McNemar's test finds the better one."""
    power = 0.0
    shares = [better, worse, 1 - better - worse]
    for only_better in range(pairs + 1):
        for only_worse in range(min(only_better, pairs - only_better + 1)):
            different = only_better + only_worse
            if stats.binomtest(only_worse, different).pvalue <= alpha:
                table = [only_better, only_worse, pairs - different]
                power += float(stats.multinomial.pmf(table, pairs, shares))
    return power


def independent_power() -> list[list[float]]:
    """Trials of each, the better and the worse rate, alpha, power."""
    cases = [(20, 0.9, 0.5, 0.05), (35, 0.95, 0.7, 0.05), (30, 1.0, 0.8, 0.025)]
    return [[*case, power_of_trials(*case)] for case in cases]


def power_of_trials(trials: int, better: float, worse: float, alpha: float) -> float:
    """The probability of all tables with which Fisher's test finds the better one."""
    numbers = range(trials + 1)
    chances = [stats.binom.pmf(numbers, trials, rate) for rate in (better, worse)]
    return sum(
        float(chances[0][passed] * chances[1][other])
        for passed in numbers
        for other in range(passed)
        if fisher_p(passed, trials, other, trials) <= alpha
    )
