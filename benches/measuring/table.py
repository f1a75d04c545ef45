"""The judgements as text, as Markdown, and as JSON."""

from __future__ import annotations

import json
from collections.abc import Iterable, Sequence
from pathlib import Path

from measuring.judge import Judgement
from measuring.model import Group, MeasuringError
from measuring.others import NOISY_SHARE

TIMES = "\N{MULTIPLICATION SIGN}"
HEADER = ("what", "measured", "to its peer", "limit", "verdict")
BEGIN = "<!-- table: written by benches/bench.py -->"
END = "<!-- table: end -->"


def row(judgement: Judgement) -> list[str]:
    """The cells of a line."""
    line = judgement.line
    measured = ratio = limit = ""
    if judgement.value is not None:
        measured = f"{number(judgement.value)} {line.unit}"
    if judgement.ratio is not None and judgement.ratios:
        spread = f"{number(min(judgement.ratios))} to {number(max(judgement.ratios))}"
        ratio = f"{number(judgement.ratio)} {TIMES} {line.peer} ({spread})"
    elif line.peer:
        ratio = f"? {TIMES} {line.peer}"
    if line.limit is not None:
        sign = "≥" if line.limit.at_least else "≤"
        unit = TIMES if line.limit.of_ratio else line.unit
        limit = f"{sign} {number(line.limit.bound)} {unit}"
        limit = limit if line.limit.required else f"goal {limit}"
    return [line.what, measured, ratio, limit, judgement.verdict]


def number(value: float) -> str:
    """Formats a number with three significant digits."""
    if abs(value) >= 100:
        return f"{value:,.0f}".replace(",", " ")
    return f"{value:#.3g}".rstrip(".")


def text(judgements: Sequence[Judgement]) -> str:
    """The table for a terminal."""
    rows = [list(HEADER)] + [row(judgement) for judgement in judgements]
    widths = [max(len(cells[column]) for cells in rows) for column in range(len(HEADER))]
    lines = ["  ".join(map(str.ljust, cells, widths)).rstrip() for cells in rows]
    lines.insert(1, "  ".join("-" * width for width in widths))
    return "\n".join(lines)


def markdown(rows: Iterable[str]) -> str:
    """The table for a page."""
    return "\n".join([markdown_row(HEADER), markdown_row(["---"] * len(HEADER)), *rows])


def markdown_row(texts: Sequence[str]) -> str:
    """A row of Markdown."""
    return "| " + " | ".join(texts) + " |"


def notes(judgements: Sequence[Judgement]) -> list[str]:
    """Missing peers and other load during the measurement."""
    found = [judgement.note for judgement in judgements if judgement.note]
    shares = {judgement.group: judgement.foreign_share for judgement in judgements}
    for group, share in shares.items():
        if share >= NOISY_SHARE:
            found.append(
                f"{group}: other programs used {share:.0%} of the processors; "
                "repeat the measurement on an idle machine"
            )
    return found


def write_page(page: Path, judgements: Sequence[Judgement], groups: Sequence[Group]) -> None:
    """Replaces the table in a page, which is between two comments. Rows and notes of lines that
    were not measured stay; rows of lines that no longer exist do not.
    """
    before, begin, rest = page.read_text(encoding="utf-8").partition(BEGIN)
    written, end, after = rest.partition(END)
    if not (begin and end):
        raise MeasuringError(f"{page}: no `{BEGIN}` with a `{END}` after it")
    written_lines = written.splitlines()
    known = {line.split(" | ")[0].removeprefix("| "): line for line in written_lines}
    known |= {judgement.line.what: markdown_row(row(judgement)) for judgement in judgements}
    names = [line.what for group in groups for line in group.lines]
    rows = [known[name] for name in names if name in known]
    measured = tuple(f"- {name}: " for it in judgements for name in (it.group, it.line.what))
    others = [it for it in written_lines if it.startswith("- ") and not it.startswith(measured)]
    below = "\n".join(others + [f"- {note}" for note in notes(judgements)])
    below = f"\nDuring this measurement:\n\n{below}\n" if below else ""
    page.write_text(f"{before}{begin}\n{markdown(rows)}\n{below}{end}{after}", encoding="utf-8")


def as_json(judgements: Sequence[Judgement]) -> str:
    """All results as JSON."""
    return json.dumps([entry(judgement) for judgement in judgements], indent=2) + "\n"


def entry(judgement: Judgement) -> dict[str, object]:
    """The JSON object of a line."""
    line = judgement.line
    result: dict[str, object] = {
        "group": judgement.group,
        "what": line.what,
        "value": judgement.value,
        "unit": line.unit,
        "peer": line.peer or None,
        "ratio": judgement.ratio,
        "ratios": judgement.ratios,
        "verdict": judgement.verdict or None,
        "note": judgement.note or None,
        "foreign_share": judgement.foreign_share,
    }
    if line.limit is not None:
        result["limit"] = {
            "bound": line.limit.bound,
            "of": "ratio" if line.limit.of_ratio else "value",
            "sense": "at least" if line.limit.at_least else "at most",
            "required": line.limit.required,
        }
    return result
