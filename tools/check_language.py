#!/usr/bin/env python3
"""Finds phrases to avoid in Markdown and in comments.

    check_language.py FILE…

Texts use short sentences, the active voice, and the standard term. Each pattern below has
an alternative. In source files, only comments and docstrings are searched.
"""

from __future__ import annotations

import re
import sys
from pathlib import Path

# Phrases and their alternatives.
PHRASES = {
    r"(told|tells)\b": "notified, reported, printed",
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
    r"whatever\b": "all, regardless of, in any case",
    r"(no|some|any|every)body\b": "no process, a user, the caller: name the actor",
    r"(whoever|a person)\b": "a user, the caller: name the actor",
    r"stands? (over|behind|beside|there|in the)\b": "supervises, follows, is in",
    r"(makes?|made) use of\b": "uses",
    r"it is (so|like this) because\b": "because",
    r"in the middle of\b": "during",
    r"unless told\b": "by default",
    r"does its work\b": "succeeds, works",
    r"what (is|was) (left|said|printed)\b": "leftover processes, messages, output",
    r"(is|are|was|were) not there\b": "is missing, does not exist",
    r"(is|are|was) known of\b": "is known about, unknown",
    r"knows? (of|nothing)\b": "has, does not know",
    r"meanwhile\b": "during this time, concurrently",
    r"side by side\b": "in parallel",
    r"of today\b": "current",
    r"by hand\b": "manually",
    r"the price\b": "the cost",
    r"(over and over|again and again)\b": "repeatedly",
    r"an own\b": "a separate, a private",
    r"(upon|shall)\b": "on, must",
    r"its turn\b": "when it is scheduled, next",
    r"as ever\b": "as before",
}
PATTERN = re.compile("|".join(rf"(?P<p{i}>\b{p})" for i, p in enumerate(PHRASES)), re.IGNORECASE)
INSTEAD = list(PHRASES.values())

# The start of a comment, by suffix. Other files are prose.
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
QUOTES = '"""'
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
    """The comments of a source file, without the code before them, and docstrings."""
    start = re.compile(rf"(?:^|\s)(?:{marker})\s?(.*)")
    texts = []
    string = ""  # the triple-quoted string that is open: a docstring, a value, or none
    for number, line in enumerate(lines, 1):
        match = start.search(line)
        if string == "docstring":
            texts.append((number, line))
        elif match and not string:
            texts.append((number, match.group(1)))
        if line.count(QUOTES) == 1:
            opened = "docstring" if line.lstrip().startswith(QUOTES) else "value"
            string = "" if string else opened
    return texts


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
