#!/usr/bin/env python3
"""The list of episodes of campaign files, by a second implementation of spec/campaign.md.

    episodes.py FILE…           writes FILE with the suffix .jsonl
    episodes.py --check FILE…   exit code 1 if a list differs

For valid files only. The interpreter has the packages of tools/requirements-history.txt.
"""

from __future__ import annotations

import csv
import json
import sys
import xml.etree.ElementTree as ET
from collections.abc import Callable, Iterator
from itertools import count, islice, product
from pathlib import Path
from statistics import NormalDist

from oracle import bits
from scipy.stats import qmc

SOBOL_BITS = 30
Sample = Callable[[int], str]
Row = dict[str, str]


def main() -> int:
    """Writes or compares the lists."""
    is_check = sys.argv[1] == "--check"
    files = [Path(name) for name in sys.argv[1 + is_check :]]
    failed = 0
    for file in files:
        lines = "".join(f"{line}\n" for line in episodes(file))
        stored = file.with_suffix(".jsonl")
        if not is_check:
            stored.write_text(lines)
        elif stored.read_text() != lines:
            print(f"failed: {stored} differs:\n{lines}")
            failed += 1
    print(f"{len(files) - failed} passed, {failed} failed")
    return 1 if failed or not files else 0


def episodes(file: Path) -> Iterator[str]:
    """The lines of a list."""
    campaign = ET.parse(file).getroot()
    seed, wanted = int(campaign.get("seed", "0")), int(campaign.get("episodes", "0"))
    tables: list[list[Row]] = []
    samples: dict[str, Sample] = {}
    names: list[str] = []
    for parameter in campaign.iter("parameter"):
        rows = table(file, parameter)
        if rows:
            tables.append(rows)
            names += rows[0]
        else:
            name = parameter.attrib["name"]
            names.append(name)
            dimension = sum(p.get("distribution") == "sobol" for p in campaign.iter("parameter"))
            used = sum(s.startswith("sobol/") for s in samples)
            unit = units(parameter, seed, wanted, (dimension, used))
            key = f"sobol/{name}" if parameter.get("distribution") == "sobol" else name
            samples[key] = value(parameter, unit)
    combinations = [merged(rows) for rows in product(*tables)]
    allowed = conditions(campaign)

    def candidates() -> Iterator[str]:
        identifier = 0
        for candidate in count() if wanted else range(len(combinations)):
            values = dict(combinations[candidate % len(combinations)])
            for key, sample in samples.items():
                values[key.removeprefix("sobol/")] = sample(candidate)
            if not allowed(values):
                continue
            identifier += 1
            episode = {
                "id": identifier,
                "seed": bits(seed, "seed", "", candidate) >> 33,
                "parameters": {name: values[name] for name in names},
            }
            yield json.dumps(episode, separators=(",", ":"), ensure_ascii=False)

    return trials(campaign, islice(candidates(), wanted or None))


def trials(campaign: ET.Element, blocks: Iterator[str]) -> Iterator[str]:
    """Each line once with each version, if there are versions."""
    element = campaign.find("versions")
    if element is None:
        yield from blocks
        return
    name, versions = element.attrib["parameter"], element.attrib["values"].split()
    masked = sorted(versions, key=len, reverse=True) if element.get("blinded") == "true" else []
    number = count(1)
    for block, line in enumerate(blocks):
        condition = json.loads(line)
        for version in order(int(campaign.get("seed", "0")), name, len(versions), block):
            trial = {"id": next(number), "seed": condition["seed"]}
            trial["parameters"] = condition["parameters"] | {name: versions[version]}
            if masked:
                trial["masked"] = masked
            yield json.dumps(trial, separators=(",", ":"), ensure_ascii=False)


def order(seed: int, name: str, versions: int, block: int) -> list[int]:
    """The order of the versions in a block: rows of the squares of Williams."""
    square, row = divmod(block, versions)
    mirrored = versions % 2 == 1 and square % 2 == 1
    first = [0]
    for step in range(1, versions):
        first.append((first[-1] + (step if step % 2 else -step)) % versions)
    if mirrored:
        first.reverse()

    def shuffled(start: int) -> list[int]:
        return permutation(versions, lambda i: bits(seed, "order", name, start + i))

    names = shuffled(2 * versions * (square - mirrored))
    rows = shuffled(2 * versions * square + versions)
    return [names[(w + rows[row]) % versions] for w in first]


def permutation(size: int, random: Callable[[int], int]) -> list[int]:
    """0, 1, … by Fisher and Yates."""
    order = list(range(size))
    for i in range(size - 1, 0, -1):
        j = int(unit_of(random(i)) * (i + 1))
        order[i], order[j] = order[j], order[i]
    return order


def table(file: Path, parameter: ET.Element) -> list[Row]:
    """The rows of a grid or a file."""
    if parameter.get("distribution") == "grid":
        return [{parameter.attrib["name"]: word} for word in parameter.attrib["values"].split()]
    if parameter.get("distribution") == "file":
        with (file.parent / parameter.attrib["file"]).open(newline="") as lines:
            return list(csv.DictReader(lines))
    return []


def merged(rows: tuple[Row, ...]) -> Row:
    """One row with all values."""
    return {name: word for row in rows for name, word in row.items()}


def unit_of(x: int) -> float:
    """The real number with the upper 52 bits."""
    return (2 * (x >> 12) + 1) / 2**53


def units(
    parameter: ET.Element, seed: int, wanted: int, sobol: tuple[int, int]
) -> Callable[[int], float]:
    """The random numbers of a parameter."""
    name = parameter.attrib["name"]
    if parameter.get("distribution") == "sobol":
        points = qmc.Sobol(sobol[0], scramble=False, bits=SOBOL_BITS).random(1024)[:, sobol[1]]
        shift = bits(seed, "shift", name, 0) >> 32
        return lambda c: (2 * (int(points[c] * 2**32) ^ shift) + 1) / 2**33
    if parameter.get("distribution") != "latin-hypercube":
        return lambda c: unit_of(bits(seed, "value", name, c))

    def latin(c: int) -> float:
        start = c // wanted * wanted
        parts = permutation(wanted, lambda i: bits(seed, "permutation", name, start + i))
        u = (parts[c % wanted] + unit_of(bits(seed, "value", name, c))) / wanted
        return min(u, 1 - 2**-53)

    return latin


def value(parameter: ET.Element, unit: Callable[[int], float]) -> Sample:
    """The values of a parameter as texts."""
    words = parameter.get("values", "").split()
    if words:
        return lambda c: words[int(unit(c) * len(words))]
    if parameter.get("mean"):
        mean, deviation = float(parameter.attrib["mean"]), float(parameter.attrib["deviation"])
        # Wichura's algorithm, too, with the logarithm of the system.
        return lambda c: text(mean + deviation * NormalDist().inv_cdf(unit(c)))
    low, high = float(parameter.attrib["low"]), float(parameter.attrib["high"])
    return lambda c: text(low + unit(c) * (high - low))


def text(number: float) -> str:
    """The shortest text of a number."""
    shortest = repr(number).removesuffix(".0")
    if "e" not in shortest:
        return shortest
    digits, exponent = shortest.split("e")
    if exponent == "-05":
        sign = "-" if number < 0 else ""
        return f"{sign}0.0000{digits.replace('-', '').replace('.', '')}"
    return f"{digits}e{int(exponent)}"


def conditions(campaign: ET.Element) -> Callable[[Row], bool]:
    """Whether values meet all constraints, which are expressions of Python, too."""
    requires = [constraint.attrib["require"] for constraint in campaign.iter("constraint")]

    def allowed(values: Row) -> bool:
        numbers = {name: float(values[name]) for r in requires for name in values if name in r}
        return all(eval(require, {}, numbers) for require in requires)

    return allowed


if __name__ == "__main__":
    sys.exit(main())
