"""Pages of the C++ reference, one for each folder of installed headers.

Doxygen finds the declarations and the comment of each, which it hands on word for word. Signatures are shown as the
header has them. A comment is about the declaration that follows it, and those behind that without an empty line that
have the same name or the same parameters.
"""

from __future__ import annotations

import dataclasses
import re
import shutil
import subprocess
import sys
import xml.etree.ElementTree as ElementTree
from collections import Counter
from pathlib import Path
from typing import Any, Iterable, Iterator

import plain_text
from pygments.lexers import CppLexer

SOURCE = Path(__file__).resolve().parents[2]
SETTINGS = """
INPUT = "{folder}/headers"
RECURSIVE = YES
STRIP_FROM_PATH = "{folder}/headers"
OUTPUT_DIRECTORY = "{folder}"
GENERATE_HTML = NO
GENERATE_LATEX = NO
GENERATE_XML = YES
XML_PROGRAMLISTING = NO
EXTRACT_ALL = YES
MARKDOWN_SUPPORT = NO
AUTOLINK_SUPPORT = NO
SORT_MEMBER_DOCS = NO
HAVE_DOT = NO
QUIET = YES
"""
TYPES = {"class", "struct", "union", "concept", "enum", "typedef"}


@dataclasses.dataclass
class Declaration:
    """What a header declares for its users: a type with what is in it, a function, a value."""

    kind: str
    name: str  # qualified, without "poise::"
    id: str  # of Doxygen
    file: str
    line: int
    column: int
    comment: str
    references: dict[str, str]  # words of its signature, to the ids of what they name
    parameters: list[str]  # their types
    overrides: bool = False
    inside: list[Declaration] = dataclasses.field(default_factory=list)
    signature: str = ""
    anchor: str = ""

    @property
    def short(self) -> str:
        return self.name.rpartition("::")[2]

    @property
    def is_usual(self) -> bool:
        """Whether it copies, moves or destroys, as for every type."""
        copies = re.search(rf"\((const )?{re.escape(self.short)}( const)?\s*&", self.signature)
        return bool(copies or re.search(r"= (default|delete)\b|~|operator=\(", self.signature))

    @property
    def needs_words(self) -> bool:
        return not (self.is_usual or self.overrides or self.short.startswith("operator"))


@dataclasses.dataclass
class Group:
    """Declarations with one comment, or none."""

    of: list[Declaration]

    @property
    def comment(self) -> str:
        return next((one.comment for one in self.of if one.comment), "")


def public_headers() -> dict[str, list[str]]:
    """The headers that CMake installs, by folder."""
    found: dict[str, list[str]] = {}
    library = re.compile(r"^poise_add_library\((\S+)\s+HEADERS\s(.*?)SOURCES", re.M | re.S)
    for file in sorted([*SOURCE.glob("*/CMakeLists.txt"), *SOURCE.glob("*/*/CMakeLists.txt")]):
        for folder, names in library.findall(file.read_text()):
            for header in sorted(f"{folder}/{name}" for name in names.split()):
                found.setdefault(header.rpartition("/")[0], []).append(header)
    return dict(sorted(found.items()))


def for_doxygen(text: str) -> str:
    """A header whose comments Doxygen takes as they are; all lines stay where they are."""

    def verbatim(block: re.Match[str]) -> str:
        return block.group().replace("///", "///@verbatim", 1).removesuffix("\n") + " @endverbatim\n"

    text = re.sub(r"^(?: *///(?![/<]).*\n)+", verbatim, text, flags=re.M)
    return re.sub(r"///<(.*)", r"///<@verbatim\1 @endverbatim", text)


def run_doxygen(headers: Iterable[str], folder: Path) -> Path:
    """The folder of its XML."""
    shutil.rmtree(folder, ignore_errors=True)
    for header in headers:
        prepared = folder / "headers" / header
        prepared.parent.mkdir(parents=True, exist_ok=True)
        prepared.write_text(for_doxygen((SOURCE / header).read_text()))
    done = subprocess.run(
        ["doxygen", "-"], input=SETTINGS.format(folder=folder), text=True, capture_output=True, check=True)
    for line in done.stderr.splitlines():
        if "scope for class std::" not in line:  # Doxygen 1.9.4 has not read what Poise specialises
            print(line, file=sys.stderr)
    return folder / "xml"


def text_of(node: ElementTree.Element, path: str) -> str:
    found = node.find(path)
    return "".join(found.itertext()) if found is not None else ""


def comment_of(node: ElementTree.Element) -> str:
    lines = "\n".join(text.text or "" for text in node.findall("detaileddescription//verbatim")).splitlines()
    return "\n".join(re.sub(r"^(\s*///)? ?|\s+$", "", line) for line in lines).strip("\n")


def declared(node: ElementTree.Element, kind: str, name: str) -> Declaration:
    place = node.find("location")
    at = place.attrib if place is not None else {}
    references = {}
    for tag in ("type", "param", "initializer", "basecompoundref"):
        for part in node.findall(tag):
            for reference in [part, *part.iter("ref")]:
                word = re.sub(r"<.*", "", reference.text or "").rpartition("::")[2]
                references[word] = reference.get("refid", "")
    name = re.sub(r"(?<=<) | (?=>)", "", name.removeprefix("poise::"))
    return Declaration(kind, name, node.get("id", ""), at.get("file", ""),
                       int(at.get("line", 0)), int(at.get("column", 0)), comment_of(node),
                       references, [text_of(part, "type") for part in node.findall("param")],
                       node.find("reimplements") is not None)


def members_of(compound: ElementTree.Element) -> Iterator[Declaration]:
    for node in compound.findall("sectiondef/memberdef"):
        kind = node.get("kind", "")
        if kind == "friend" and text_of(node, "argsstring"):
            kind = "function"
        if node.get("prot") == "private" or kind == "friend":
            continue
        member = declared(node, kind, text_of(node, "qualifiedname"))
        for value in node.findall("enumvalue"):
            named = declared(value, "enumvalue", f"{member.name}::{text_of(value, 'name')}")
            named.signature = f"{named.short} {text_of(value, 'initializer')}".strip()
            named.file, named.line = member.file, member.line
            member.inside.append(named)
        yield member


def read_declarations(xml: Path) -> list[Declaration]:
    """What stands in namespaces, and in types what is not private."""
    found: list[Declaration] = []
    types: dict[str, Declaration] = {}
    private: set[str] = set()
    for kind in ("namespace", "class", "struct", "union", "concept"):
        for file in sorted(xml.glob(f"{kind}*.xml")):
            compound = next(iter(ElementTree.parse(file).getroot()))
            name = text_of(compound, "compoundname")
            if not name.startswith("poise") or "::detail" in name:
                continue
            if kind == "namespace":
                found += members_of(compound)
                continue
            made = declared(compound, kind, name)
            made.inside += members_of(compound)
            types[made.name] = made
            if compound.get("prot") == "private":
                private.add(made.name)
    for name, made in types.items():
        scopes = [name.rsplit("::", depth)[0] for depth in range(name.count("::") + 1)]
        if not private.intersection(scopes):
            outer = types.get(name.rpartition("::")[0])
            (outer.inside if outer else found).append(made)
    return found


def end_of_bracket(text: str, begin: int) -> int:
    depth = 0
    for place in range(begin, len(text)):
        depth += (text[place] in "([{") - (text[place] in ")]}")
        if depth == 0:
            return place + 1
    return len(text)


def signature_of(lines: list[str], one: Declaration) -> str:
    """A declaration as its header has it, without its body."""
    begin = one.line - 1
    while begin > 0 and re.match(r"\s*(?=[^\s/}#])(?!.*[;{}:]\s*(//.*)?$)", lines[begin - 1]):
        begin -= 1
    text = "\n".join(re.sub(r"\s*//.*", "", line) for line in lines[begin:begin + 40])
    place = 0
    parameters = False
    while place < len(text) and text[place] != ";":
        if text[place] == "{" and one.kind in (*TYPES, "function"):
            break
        if parameters and re.match(r"[^:]:[^:]", text[place - 1:place + 2]):  # what a constructor initialises
            break
        if text[place] in "([{":
            parameters = parameters or (one.kind == "function" and text[place] == "(")
            place = end_of_bracket(text, place)
        else:
            place += 1
    kept = text[:place].rstrip().split("\n")
    margin = len(kept[0]) - len(kept[0].lstrip())
    return "\n".join([kept[0].strip(), *(line[min(margin, len(line) - len(line.lstrip())):] for line in kept[1:])])


def groups_of(declarations: Iterable[Declaration], lines: list[str]) -> list[Group]:
    """Declarations in their order, each with those about which its comment is too."""
    groups: list[Group] = []
    last: Declaration | None = None
    for one in sorted(declarations, key=lambda one: (one.line, one.column)):
        if last and last.kind == one.kind and belong_together(last, one, groups[-1].comment, lines):
            groups[-1].of.append(one)
        else:
            groups.append(Group([one]))
        last = one
    return groups


def belong_together(last: Declaration, one: Declaration, comment: str, lines: list[str]) -> bool:
    if last.line == one.line:  # double from = 0.0, to = 1.0;
        return one.kind == "variable"
    apart = any(re.match(r"\s*($|//|(public|protected):)", line) for line in lines[last.line:one.line - 1])
    if apart or one.comment or one.inside or last.inside or one.is_usual != last.is_usual:
        return False
    alike = one.name == last.name or (one.parameters == last.parameters and one.parameters)
    return not comment or (one.kind == "function" and bool(alike) and "///<" not in lines[last.line - 1])


def page_of(header: str) -> str:
    return f"cpp/{header.rpartition('/')[0].replace('/', '-')}.md"


def tasks_of_library() -> list[list[str]]:
    """Tasks, functions and headers: the rows of the table of docs/library.md that has these columns."""
    page = (SOURCE / "docs" / "library.md").read_text()
    table = re.search(r"^\| task \| functions \| header \|\n\| ---.*\n((?:\|.*\n)+)", page, re.M)
    if table is None:
        raise SystemExit("docs/library.md: expected a table with the columns task, functions and header")
    return [row.strip("| ").split(" | ") for row in table.group(1).splitlines()]


class Reference:
    """All declarations, where each of them stands in the pages, and the pages."""

    def __init__(self, declarations: list[Declaration], headers: dict[str, list[str]]) -> None:
        self.headers = headers
        self.lines = {header: (SOURCE / header).read_text().splitlines() for of in headers.values() for header in of}
        self.by_file: dict[str, list[Declaration]] = {header: [] for header in self.lines}
        self.places: dict[str, str] = {}  # page and anchor of the ids of Doxygen, and of headers
        self.named: dict[str, list[Declaration]] = {}
        self.written = Declaration("", "", "", "", 0, 0, "", {}, [])  # whose comment is
        self.count = 0
        self.without_words: Counter[str] = Counter()  # by kind
        self.page = ""  # the one that is written
        self.lexer = CppLexer()
        taken: set[str] = set()
        for one in sorted(declarations, key=lambda one: (one.file, one.line)):
            if one.file in self.by_file:
                self.by_file[one.file].append(one)
                self.place(one, taken)
        for header in self.lines:
            self.places[header] = f"{page_of(header)}#{Path(header).name}"

    def place(self, one: Declaration, taken: set[str]) -> None:
        page = page_of(one.file)
        anchor = re.sub(r"[^\w.~]+", "-", one.name.replace("::", ".")).strip("-")
        numbers = ("", *(f"-{number}" for number in range(2, 1000)))
        one.anchor = next(anchor + number for number in numbers if f"{page}#{anchor}{number}" not in taken)
        place = f"{page}#{one.anchor}"
        taken.add(place)
        self.places[one.id] = place
        self.named.setdefault(one.name, []).append(one)
        one.signature = one.signature or signature_of(self.lines[one.file], one)
        for member in one.inside:
            self.place(member, taken)

    def link(self, name: str) -> str | None:
        """The address, in Markdown, of what a comment names: a declaration, a header or a page of docs/."""
        if name.startswith("docs/"):
            return "../" + name.removeprefix("docs/")
        if name in self.places:
            return self.relative(self.places[name])
        if not re.search(r"[A-Z_:]|\(\)$", name):
            return None  # a word, or a parameter
        scopes = self.written.name.split("::")
        for depth in range(len(scopes), -1, -1):
            found = self.named.get("::".join([*scopes[:depth], name.removesuffix("()")]), [])
            near = [one for one in found if one.file == self.written.file] or found
            if len({one.file for one in near}) == 1:
                return self.relative(self.places[near[0].id])
        return None

    def relative(self, place: str) -> str:
        return place.removeprefix(self.page) if place.startswith(f"{self.page}#") else place.removeprefix("cpp/")

    def named_by(self, one: Declaration, name: str) -> str | None:
        """The address, in HTML, of what a word of a signature names."""
        place = self.places.get(one.references.get(name, ""))
        return self.relative(place).replace(".md#", ".html#") if place else None

    def block(self, group: Group, headed: bool = False) -> str:
        """The signatures of functions and types. A heading has the anchor of the first."""
        shown = []
        for one in group.of:
            text = plain_text.signature(one.signature, self.lexer, lambda name: self.named_by(one, name))
            shown.append(text if headed and one is group.of[0] else f'<span id="{one.anchor}">{text}</span>')
        return plain_text.signatures(shown)

    def item(self, group: Group) -> str:
        """Values, as an item of a list."""
        anchors: dict[str, str] = {}  # of what is shown once: double from = 0.0, to = 1.0
        for one in group.of:
            text = plain_text.escape(" ".join(one.signature.split()))
            for name in sorted(one.references):
                if name and (address := self.named_by(one, name)):
                    text = re.sub(rf"(?<![&#\w]){name}\b", f'<a href="{address}">{name}</a>', text, count=1)
            anchors[text] = anchors.get(text, "") + f'<span id="{one.anchor}"></span>'
        shown = [f"{anchor}<code>{text}</code>" for text, anchor in anchors.items()]
        words = self.words(group)
        return "- " + "<br>\n    ".join([*shown, plain_text.indented(words)] if words else shown)

    def words(self, group: Group) -> str:
        self.written = group.of[0]
        return plain_text.markdown(group.comment, self.link)

    def counted(self, group: Group) -> None:
        self.count += len(group.of)
        if not group.comment and group.of[0].kind != "enumvalue":
            self.without_words[group.of[0].kind] += sum(one.needs_words for one in group.of)

    def members(self, one: Declaration, level: int) -> Iterator[str]:
        nested = [member for member in one.inside if member.kind in TYPES and member.kind != "typedef"]
        for group in groups_of((member for member in one.inside if member not in nested), self.lines[one.file]):
            self.counted(group)
            if group.of[0].kind in ("variable", "enumvalue"):
                yield self.item(group)
            else:
                yield self.block(group)
                yield self.words(group)
        for group in groups_of(nested, self.lines[one.file]):
            yield from self.entry(group, level + 1)

    def entry(self, group: Group, level: int) -> Iterator[str]:
        self.counted(group)
        names = list(dict.fromkeys(one.name for one in group.of))
        yield f"{'#' * level} {plain_text.escape(', '.join(names[:4]))} {{#{group.of[0].anchor}}}"
        yield self.block(group, headed=True)
        yield self.words(group)
        for one in group.of:
            yield from self.members(one, level)

    def opening(self, header: str) -> str:
        """The comment with which a header begins."""
        found = re.match(r"#pragma once\n+((?:// .*\n|//\n)+)\n", "\n".join(self.lines[header]) + "\n")
        return re.sub(r"^// ?", "", found.group(1), flags=re.M).strip() if found else ""

    def folder_page(self, folder: str, about: str) -> str:
        self.page = page_of(f"{folder}/")
        rows = ["| header | declares |", "| --- | --- |"]
        sections: list[str] = []
        for header in self.headers[folder]:
            name = Path(header).name
            groups = groups_of(self.by_file[header], self.lines[header])
            names = dict.fromkeys(one.name for group in groups for one in group.of if "operator" not in one.name)
            rows.append(f"| [{name}](#{name}) | {', '.join(map(plain_text.code, names))} |")
            sections += [f"## {plain_text.escape(name)} {{#{name}}}", f"`#include <poise/{header}>`",
                         plain_text.markdown(self.opening(header), self.link)]
            if not groups:
                sections.append("What it has is used by other headers only.")
            for group in groups:
                sections += self.entry(group, 3)
        begin = [f"# {plain_text.escape(folder)}", plain_text.prose(about, self.link), "\n".join(rows)]
        return "\n\n".join(part for part in [*begin, *sections] if part) + "\n"

    def index_page(self, about: dict[str, str]) -> str:
        self.page = "cpp/index.md"
        tasks = [
            ["a scene from a file", "`read_scene`", "`<poise/model/scene.hpp>`"],
            ["a scene in code", "`SceneBuilder`, `measures::distance`", "`<poise/model/scene_builder.hpp>`"],
            ["an equilibrium, proved, read by names", "`solve`, `NamedEquilibrium`",
             "`<poise/statics/equilibrium/named_equilibrium.hpp>`"],
            ["the same of a compiled scene, by indices", "`StaticModel`, `solve`",
             "`<poise/statics/model/static_model.hpp>`, `<poise/statics/equilibrium/equilibrium.hpp>`"],
        ]
        tasks += tasks_of_library()
        table = ["| task | functions and types | header |", "| --- | --- | --- |"]
        for task, names, files in tasks:
            headers: list[str] = re.findall(r"<poise/(.*?)>", files)
            table.append(f"| {task.replace('](', '](../')} | "
                         + re.sub(r"`([^`]+)`", lambda name: self.function(str(name.group(1)), headers), names) + " | "
                         + ", ".join(f"[{header}]({self.relative(self.places[header])})" for header in headers) + " |")
        folders = ["| folder | what it contains |", "| --- | --- |"]
        for folder in self.headers:
            words = plain_text.prose(about.get(folder, ""), self.link)
            folders.append(f"| [{plain_text.escape(folder)}]({Path(page_of(f'{folder}/')).name}) | {words} |")
        return "\n\n".join([
            "# Reference of C++",
            "`#include <poise/poise.hpp>` and the target `poise::poise` give everything. [Poise in C++](../library.md) "
            "shows how it is used; here is every declaration of the installed headers. All numbers are in SI units "
            "(m, N, kg, rad, s) unless a comment names others. Bad input throws `poise::InputError`; that a search "
            "does not succeed is the status of its result.",
            "## What to begin with", "\n".join(table), "## All folders", "\n".join(folders)]) + "\n"

    def function(self, name: str, headers: list[str]) -> str:
        """A name of the table of docs/library.md, with a link to it, in one of these headers if it is there."""
        found = sorted(self.named.get(name, []), key=lambda one: one.file not in headers)
        if not found:
            raise SystemExit(f"docs/library.md: expected a declaration of Poise, found {name}")
        return f"[{plain_text.code(name)}]({self.relative(self.places[found[0].id])})"


def what_folders_contain() -> dict[str, str]:
    """From the tables of docs/architecture.md."""
    found = {}
    for heading, rows in re.findall(r"^\| (folder|wing of `\w+/`) \|.*\n\| ---.*\n((?:\|.*\n)+)",
                                    (SOURCE / "docs" / "architecture.md").read_text(), re.M):
        parent = "" if heading == "folder" else heading.split("`")[1]
        for row in re.findall(r"^\| `([\w/]+)/` \|.* \| (.*) \|$", rows, re.M):
            words = re.sub(r"\[(.*?)\]\(.*?\)", r"docs/\1", row[1])
            found[parent + row[0]] = words[0].upper() + words[1:]
    return found


def write_pages(pages: Path, build: Path) -> list[Any]:
    headers = public_headers()
    xml = run_doxygen((header for of in headers.values() for header in of), build / "site" / "doxygen")
    reference = Reference(read_declarations(xml), headers)
    about = what_folders_contain()
    (pages / "cpp").mkdir(parents=True, exist_ok=True)
    (pages / "cpp" / "index.md").write_text(reference.index_page(about))
    for folder in headers:
        (pages / page_of(f"{folder}/")).write_text(reference.folder_page(folder, about.get(folder, "")))
    values, functions = reference.without_words["variable"], reference.without_words["function"]
    print(f"C++: {len(reference.lines)} headers, {reference.count} declarations, "
          f"{reference.without_words.total()} without a comment of their own: {values} values, {functions} functions, "
          f"{reference.without_words.total() - values - functions} types")
    return [{"Reference of C++": ["cpp/index.md", *({folder: page_of(f"{folder}/")} for folder in headers)]}]


if __name__ == "__main__":
    write_pages(Path(sys.argv[2]), Path(sys.argv[1]))
