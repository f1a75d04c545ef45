#!/usr/bin/env python3
"""Collects the pages of the guide for mdBook.

    stage_docs.py RTF DIRECTORY

DIRECTORY/src gets the pages that docs/SUMMARY.md lists, with their links changed to the places
below. Everything else that a page links to is copied to DIRECTORY/src/files. A page that is
not in SUMMARY.md, and a link to a missing file, are errors.

    docs/how-to/web.md    how-to/web.md
    spec/suite.md         spec/suite.md
    fixtures/needs.json   files/fixtures/needs.json
"""

from __future__ import annotations

import os
import re
import shutil
import sys
from pathlib import Path

from cli_reference import cli_reference

TOP = Path(__file__).resolve().parent.parent
DOCS = Path("docs")

LINK = re.compile(r"(\]\()([^)\s#]*)(#[^)\s]*)?(\))")
# Links in code are text.
CODE = re.compile(r"^(?:```|~~~).*?^(?:```|~~~)$|`[^`\n]+`", re.M | re.S)
GENERATED = "<!-- generated: command line -->\n"


def main() -> None:
    """Stages all pages."""
    rtf, directory = Path(sys.argv[1]).resolve(), Path(sys.argv[2])
    guide = Guide(directory / "src")
    guide.stage()
    page = guide.source / "reference" / "cli.md"
    text = page.read_text()
    if GENERATED not in text:
        guide.problems.append(f"docs/reference/cli.md has no line `{GENERATED.strip()}`")
    page.write_text(text.replace(GENERATED, cli_reference(rtf)))
    shutil.copy(TOP / DOCS / "book.toml", directory)
    if guide.problems:
        raise SystemExit("\n".join(f"error: {problem}" for problem in guide.problems))


class Guide:
    """The pages, by their paths in the repository, and the directory for them."""

    def __init__(self, source: Path) -> None:
        self.source = source
        self.problems: list[str] = []
        summary = (TOP / DOCS / "SUMMARY.md").read_text()
        self.pages = {resolve(DOCS, link[1]) for link in LINK.findall(summary)}
        self.pages.add(DOCS / "SUMMARY.md")

    def stage(self) -> None:
        """Writes all pages and the files that they link to."""
        shutil.rmtree(self.source, ignore_errors=True)
        for page in sorted(self.pages):
            if not (TOP / page).exists():
                self.problems.append(f"docs/SUMMARY.md lists {page}, which does not exist")
                continue
            target = self.source / staged(page)
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_text(self.rewrite(page, (TOP / page).read_text()))
        for page in sorted((TOP / DOCS).rglob("*.md")):
            if page.relative_to(TOP) not in self.pages:
                self.problems.append(f"docs/SUMMARY.md does not list {page.relative_to(TOP)}")

    def rewrite(self, page: Path, text: str) -> str:
        """The page's text with links to the staged places."""
        result, position = [], 0
        for code in CODE.finditer(text):
            result += [self.relink(page, text[position : code.start()]), code.group()]
            position = code.end()
        return "".join([*result, self.relink(page, text[position:])])

    def relink(self, page: Path, text: str) -> str:
        """Prose with links to the staged places."""
        return LINK.sub(lambda link: self.link(page, link), text)

    def link(self, page: Path, link: re.Match[str]) -> str:
        """One link."""
        start, path, anchor, end = link.groups(default="")
        if not path or "://" in path or path.startswith("mailto:"):
            return link.group()
        target = resolve(page.parent, path)
        if target == Path("README.md"):
            # The guide's first page replaces that of the repository.
            target, anchor = DOCS / target, ""
        if (TOP / target).is_dir() and target / "README.md" in self.pages:
            target /= "README.md"
        if target in self.pages:
            place = staged(target)
        elif target.suffix == ".md" or not (TOP / target).is_file():
            self.problems.append(f"{page} links to {path}, which is not a page or a file")
            return link.group()
        else:
            place = Path("files") / target if target.parts[0] != "docs" else staged(target)
            (self.source / place).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(TOP / target, self.source / place)
        relative = os.path.relpath(place, staged(page).parent)
        return f"{start}{relative}{anchor}{end}"


def resolve(directory: Path, path: str) -> Path:
    """A link's target, relative to the root of the repository."""
    return Path(os.path.normpath(directory / path))


def staged(page: Path) -> Path:
    """The place of a page in the book: docs/ is its root."""
    place = page.relative_to(DOCS) if page.parts[0] == "docs" else page
    # mdBook would rename it, but not change the links to it.
    return place.with_name("index.md") if place.name == "README.md" else place


if __name__ == "__main__":
    main()
