"""The reference of the command line, in Markdown, from the help of `rtf` and its verbs."""

from __future__ import annotations

import os
import re
import subprocess
from collections.abc import Iterator
from pathlib import Path

# `rtf` itself and its verbs have these options.
COMMON = ("--color", "--help", "--version")

VERB = re.compile(r"^  ([a-z-]+)  ", re.M)
SECTION = re.compile(r"^([A-Z][^\n]*):\n((?:(?: .*)?\n|(?=\Z))*)", re.M)
ENTRY = re.compile(r"^ {2,6}(-\S.*|[\[<].*)$")


def cli_reference(rtf: Path) -> str:
    """A section for each verb, with its options."""
    return "\n".join(verb(rtf, words) for words in [(), *verbs(rtf, ())])


def verbs(rtf: Path, words: tuple[str, ...]) -> Iterator[tuple[str, ...]]:
    """All verbs below a verb."""
    commands = re.search(r"^Commands:\n((?:  .*\n)+)", help_of(rtf, words), re.M)
    for name in VERB.findall(commands.group(1)) if commands else []:
        if name != "help":
            yield (*words, name)
            yield from verbs(rtf, (*words, name))


def help_of(rtf: Path, words: tuple[str, ...]) -> str:
    """The long help, without colours and values of this environment."""
    variables = {name: value for name, value in os.environ.items() if not name.startswith("RTF_")}
    ran = subprocess.run(
        [rtf, *words, "--help"], env=variables, capture_output=True, text=True, check=True
    )
    return ran.stdout


def verb(rtf: Path, words: tuple[str, ...]) -> str:
    """The section of one verb."""
    text = help_of(rtf, words)
    about, rest = text.split("\nUsage: ", 1)
    usage, rest = rest.split("\n\n", 1)
    parts = [f"## `{' '.join(('rtf', *words))}`\n", escape(about), f"```text\n{usage}\n```\n"]
    for title, lines in SECTION.findall(rest):
        if title == "Commands":
            continue
        shown = entries(lines) if ENTRY.match(lines.split("\n")[0]) else [block(lines)]
        if words:
            shown = [
                entry
                for entry in shown
                if not any(
                    f"{name}`" in entry.split("\n")[0] or f"{name} " in entry.split("\n")[0]
                    for name in COMMON
                )
            ]
        if shown:
            parts += [f"### {title}\n", *shown]
    return "\n".join(parts)


def entries(lines: str) -> list[str]:
    """A list of arguments or options."""
    found: list[list[str]] = []
    for line in lines.split("\n"):
        if entry := ENTRY.match(line):
            found.append([f"- `{entry.group(1).strip()}`", ""])
        else:
            found[-1].append(line.strip())
    return [item(entry) for entry in found]


def item(entry: list[str]) -> str:
    """One argument or option: its paragraphs, and its possible values as a list."""
    text = escape("\n".join(entry[1:])).strip()
    return "\n".join([entry[0], "", *(f"  {line}".rstrip() for line in text.split("\n")), ""])


def block(lines: str) -> str:
    """Text with aligned columns."""
    return f"```text\n{lines.rstrip()}\n```\n"


def escape(text: str) -> str:
    """Text without Markdown's special characters, except for code."""
    parts = re.split(r"(`[^`]*`)", text)
    return "".join(
        part if part.startswith("`") else re.sub(r"([<>*_\[\]])", r"\\\1", part) for part in parts
    )
