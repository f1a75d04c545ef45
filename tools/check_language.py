#!/usr/bin/env python3
"""Finds phrases that no colleague would say, in prose and in comments.

    check_language.py FILE…

STYLE: short sentences, active voice, the field's standard term. Each pattern below has
the term to use instead. Code is only searched in its comments.
"""

from __future__ import annotations

import re
import sys
from pathlib import Path

# A phrase, and what to write instead.
PHRASES = {
    r"(is|are|was|were|be|been) told\b": "is notified, is reported, is printed",
    r"of (its|their|our|one's) own\b": "separate, dedicated, private, its",
    r"beside\b": "next to, in addition to",
    r"folders?\b": "directory",
    r"(goes|go|went|going) on\b": "continues",
    r"(comes?|came) to (its|their|an) ends?\b": "finishes",
    r"at the most\b": "at most",
    r"at the least\b": "at least",
    r"for ever\b": "forever, indefinitely, without limit",
    r"looks? whether\b": "checks whether",
    r"(looked|looks|look) at\b": "checked, inspected, polled",
    r"by force\b": "kill, killed",
    r"(is|are|was) over\b": "has ended, has finished",
    r"anew\b": "again, from the start",
    r"to and fro\b": "back and forth",
    r"whatever happen(s|ed)\b": "always, in any case",
    r"(nobody|somebody|whoever)\b": "no process, a user, the caller: name the actor",
    r"stands? (over|behind|beside)\b": "supervises, follows, is next to",
    r"(makes?|made) use of\b": "uses",
    r"it is (so|like this) because\b": "because",
    r"in the middle of\b": "during",
    r"unless told\b": "by default",
    r"does its work\b": "succeeds, works",
}
PATTERN = re.compile("|".join(rf"(?P<p{i}>\b{p})" for i, p in enumerate(PHRASES)), re.IGNORECASE)
INSTEAD = list(PHRASES.values())

# Where a comment starts, by the file's suffix; prose has none.
COMMENT = {
    ".rs": r"//[/!]?",
    ".ts": r"//|/?\*",
    ".svelte": r"//|<!--|/?\*",
    ".h": r"//|/?\*",
    ".hpp": r"//|/?\*",
    ".c": r"//|/?\*",
    ".cpp": r"//|/?\*",
    ".py": r"#|\"\"\"",
    ".rb": r"#",
    ".sh": r"#",
    ".toml": r"#",
    ".lua": r"--",
    ".adb": r"--",
    ".ads": r"--",
    ".gpr": r"--",
    ".xml": r"<!--",
}
FENCE = re.compile(r"^\s*(```|    )")
CODE = re.compile(r"`[^`]*`|\]\([^)]*\)")


def main() -> None:
    """Prints every finding; exit code 1 if there is one."""
    findings = [found for name in sys.argv[1:] for found in check(Path(name))]
    print("\n".join(findings))
    sys.exit(1 if findings else 0)


def check(file: Path) -> list[str]:
    """The findings in one file."""
    marker = COMMENT.get(file.suffix)
    lines = file.read_text(errors="replace").splitlines()
    texts = comments(lines, marker) if marker else prose(lines)
    found = []
    for number, text in texts:
        for match in PATTERN.finditer(CODE.sub("``", text)):
            instead = INSTEAD[int((match.lastgroup or "p0")[1:])]
            found.append(f"{file}:{number}: `{match.group()}`: write {instead}")
    return found


def comments(lines: list[str], marker: str) -> list[tuple[int, str]]:
    """The comments of a source file, without the code before them."""
    start = re.compile(rf"(?:^|\s)(?:{marker})\s?(.*)")
    matches = ((number, start.search(line)) for number, line in enumerate(lines, 1))
    return [(number, match.group(1)) for number, match in matches if match]


def prose(lines: list[str]) -> list[tuple[int, str]]:
    """The text of a Markdown file, without its code blocks."""
    texts = []
    fenced = False
    for number, line in enumerate(lines, 1):
        match = FENCE.match(line)
        if match and match.group(1) == "```":
            fenced = not fenced
        elif not fenced and not match:
            texts.append((number, line))
    return texts


if __name__ == "__main__":
    main()
