"""Makes the pages that mkdocs reads from the Markdown of the repository: comments vanish and links are rewritten."""

from __future__ import annotations

import os
import re
import shutil
from collections.abc import Callable
from pathlib import Path

SOURCE = Path(__file__).resolve().parents[2]
HERE = Path("docs/site")

#: Pages whose names on the site are others.
RENAMED = {"README.md": "tour.md", "landing.md": "index.md"}
#: Files of pages that are theirs alone.
ASSETS = [HERE / "site.css", HERE / "theme/search.js"]
#: The languages in which files that links name are shown.
LANGUAGES = {".toml": "toml", ".cpp": "cpp", ".hpp": "cpp", ".py": "python", ".csv": "text", ".txt": "text"}
LINK = re.compile(r"(!?)\[((?:[^\[\]]|\[[^\]]*\])*)\]\(([^()\s]+)\)")
FENCE = re.compile(r"^(```+|~~~+)")


class DeadLinks(Exception):
    """Links to nowhere, one a line."""


def outside_code(text: str, change: Callable[[str], str]) -> str:
    """The text with a change made to all that is in no fenced block of code."""
    parts: list[tuple[bool, list[str]]] = [(False, [])]
    fence = ""
    for line in text.splitlines(keepends=True):
        found = FENCE.match(line)
        if fence == "" and found:
            fence = found[1]
            parts.append((True, [line]))
        elif fence != "" and line.rstrip() == fence:
            fence = ""
            parts[-1][1].append(line)
            parts.append((False, []))
        else:
            parts[-1][1].append(line)
    return "".join("".join(lines) if is_code else change("".join(lines)) for is_code, lines in parts)


def as_python_markdown(text: str) -> str:
    """Markdown without comments, and with the empty line before a list that Python's Markdown wants."""
    text = re.sub(r"<!--.*?-->\n?", "", text, flags=re.DOTALL)
    return re.sub(r"^(?!- |\d+\. | |\n|$)(.*\n)(?=- )", r"\1\n", text, flags=re.MULTILINE)


class Stage:
    """The folder of pages. What parts write into it comes first, so that links can lead there."""

    def __init__(self, pages: Path, complete: bool) -> None:
        self.pages = pages
        self.complete = complete
        sources = [path for folder in (SOURCE, SOURCE / "docs", SOURCE / HERE) for path in sorted(folder.glob("*.md"))]
        self.names = {path.relative_to(SOURCE): RENAMED.get(path.name, path.name.lower()) for path in sources}
        self.files: list[Path] = []
        self.dead: list[str] = []

    def write(self) -> None:
        """Writes all pages of the repository, the files they name, and their pictures."""
        for source, name in self.names.items():
            page = self.pages / name
            # A part may have written another form of it, with the same links.
            text = (page if page.is_file() else SOURCE / source).read_text(encoding="utf-8")
            page.write_text(self.page(text, source, name), encoding="utf-8")
        for source in self.files:
            self.write_file(source)
        for source in ASSETS:
            target = self.pages / "assets" / source.name
            target.parent.mkdir(exist_ok=True)
            shutil.copy(SOURCE / source, target)
        if self.dead:
            raise DeadLinks("\n".join(self.dead))

    def page(self, text: str, source: Path, name: str) -> str:
        if source == Path("README.md"):
            text = text.replace("# Poise\n", "# Tour of the commands\n", 1)
        return outside_code(text, lambda part: LINK.sub(
            lambda link: self.link(link, source, name), as_python_markdown(part)))

    def link(self, link: re.Match[str], source: Path, name: str) -> str:
        """A link of a page, as it leads to the same on the site."""
        mark, words, address = link.groups()
        words = LINK.sub(lambda inner: self.link(inner, source, name), words)
        if re.match(r"[a-z]+:|#", address):
            return f"{mark}[{words}]({address})"
        place, _, anchor = address.partition("#")
        path = Path(os.path.normpath(source.parent / place))
        target = self.target(path)
        if target is None:
            self.dead.append(f"{source}: nothing is at {address}")
            return words
        if target == "":
            return words
        if words in (place, path.name) and path in self.names:
            words = self.title(path)
        address = os.path.relpath(target, Path(name).parent) + (f"#{anchor}" if anchor else "")
        return f"{mark}[{words}]({address})"

    def title(self, source: Path) -> str:
        """The first heading of a page, which stands where others name its file."""
        return (SOURCE / source).read_text(encoding="utf-8").partition("\n")[0].lstrip("# ")

    def target(self, path: Path) -> str | None:
        """The file of the site for one of the repository; empty where it has none, None where there is nothing."""
        if path in self.names:
            return self.names[path]
        place = place_in_a_part(path)
        page, _, anchor = place.partition("#")
        if (self.pages / page).is_file() and anchor in (self.pages / page).read_text(encoding="utf-8"):
            return place
        if (SOURCE / path).is_dir():
            return ""
        if (SOURCE / path).is_file():
            if path not in self.files:
                self.files.append(path)
            return str(path.relative_to("docs")) if is_shown_as_it_is(path) else f"files/{path}.md"
        # What parts write is linked from docs/site/ as if it were beside it.
        return "" if path.is_relative_to(HERE) and not self.complete else None

    def write_file(self, source: Path) -> None:
        """A file that a page names: as it is where browsers show it, else as a page with the file beside it."""
        if is_shown_as_it_is(source):
            target = self.pages / source.relative_to("docs")
            target.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(SOURCE / source, target)
            if source.suffix == ".html":
                report = target.read_text(encoding="utf-8")
                framed = (SOURCE / HERE / "framed.html").read_text(encoding="utf-8")
                target.write_text(report.replace("</body>", f"{framed}</body>"), encoding="utf-8")
            return
        page = self.pages / "files" / f"{source}.md"
        page.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(SOURCE / source, page.with_suffix(""))
        text = (SOURCE / source).read_text(encoding="utf-8").rstrip("\n")
        language = LANGUAGES.get(source.suffix, "text")
        page.write_text(f"# {source}\n\n[Download]({source.name})\n\n````{language}\n{text}\n````\n", encoding="utf-8")


def place_in_a_part(path: Path) -> str:
    """Where the parts of the site describe a file or a folder, if they do."""
    if path.is_relative_to(HERE):
        return str(path.relative_to(HERE))
    if path.parts[0] == "datasets":
        return str(Path("gallery", *(path.parts[1:] or ["index"])).with_suffix(".md"))
    if path.suffix == ".hpp":
        return f"cpp/{'-'.join(path.parent.parts)}.md#{path.name}"
    return "none"


def is_shown_as_it_is(path: Path) -> bool:
    return path.is_relative_to("docs") and path.suffix in (".svg", ".png", ".html")
