"""The gallery of the site: a page for every file of datasets/ with a report in which its mechanism moves.

    /usr/bin/python3 docs/site/gallery.py BUILD PAGES

runs the command lines of gallery.toml with BUILD/poise, keeps their reports in BUILD/reports, so that what has not
changed is not made again, and writes PAGES/gallery/NAME.md of each file
NAME.toml, with its reports in a folder beside it.
"""

from __future__ import annotations

import html
import json
import pathlib
import re
import shutil
import sys
import time
import tomllib
from typing import Any, Callable, Iterator

import commands
from gallery_picture import figure_that_plays, picture_of
from gallery_report import DATASETS, ReportError, Reports, document_of, named_files

TABLE = pathlib.Path(__file__).with_name("gallery.toml")
LARGEST = 1_000_000  # bytes of a report

#: Sections of pages of docs/ that explain what a file has: a word, the page, and how it is known.
FEATURES: list[tuple[str, str, Callable[[dict[str, Any]], bool]]] = [
    ("scene files", "scene-files.md", lambda d: "body" in d),
    ("sections", "scene-files.md#sections", lambda d: "section" in keys_of(d, "body")),
    ("links that bend", "loads.md#links-that-bend", lambda d: "flexible" in str(d.get("body", ""))),
    ("springs, dampers and friction", "scene-files.md#force-elements",
     lambda d: bool(d.keys() & {"spring", "torsion_spring", "cubic_spring", "damper", "torsion_damper", "friction"})),
    ("gas struts", "scene-files.md#gas-struts", lambda d: "gas" in keys_of(d, "spring")),
    ("bump stops", "scene-files.md#bump-stops", lambda d: "bump_stop" in d),
    ("stops", "scene-files.md#stops", lambda d: "stop" in d),
    ("gears, cams and ropes", "scene-files.md#gears-cams-and-ropes",
     lambda d: bool(d.keys() & {"gear", "belt", "rack", "coupling", "geneva", "cam", "rope", "chain"})),
    ("curved slots and rolling wheels", "scene-files.md#curved-slots-and-rolling-wheels",
     lambda d: bool(d.keys() & {"circular_slot", "curved_slot", "rolling"})),
    ("profiles that roll", "scene-files.md#profiles-that-roll", lambda d: "rolling_profile" in d),
    ("contacts between bodies", "contacts.md",
     lambda d: bool(d.keys() & {"contact", "curve_contact", "loose_pin", "loose_slot"})),
    ("blades", "scene-files.md#blades", lambda d: "blade" in d),
    ("friction that holds", "friction.md",
     lambda d: any("friction" in keys_of(d, table) for table in ("pin", "slide", "pin_in_slot", "rope"))),
    ("follower loads", "scene-files.md#loads", lambda d: "follows" in keys_of(d, "force")),
    ("functions of time", "scene-files.md#functions-of-time", lambda d: "time" in keys_of(d, "force")),
    ("drives", "scene-files.md#drives", lambda d: "body" in d and "drive" in d),
    ("expressions", "scene-files.md#expressions", lambda d: "numbers" in d),
    ("parts", "scene-files.md#parts", lambda d: "part" in d),
    ("design files", "design-files.md", lambda d: "variables" in d),
    ("synthesis of four-bars", "synthesis.md", lambda d: d.get("synthesis", {}).get("kind") in ("poses", "function")),
    ("linkages through points", "path-synthesis.md", lambda d: bool(d.get("synthesis", {}).get("kind") == "path")),
    ("balance", "balance.md", lambda d: "balance" in d),
    ("experiment files", "experiment-files.md", lambda d: "sensor" in d),
    ("planning runs", "planning.md", lambda d: "plan" in d),
    ("tolerances", "sensitivity.md", lambda d: "tolerances" in d),
    ("files of hard cases", "hard-cases.md", lambda d: "case" in d),
]

STYLE = """<style>
.cards-of-gallery { display: grid; gap: .8rem;
  grid-template-columns: repeat(auto-fill, minmax(min(100%, 11rem), 1fr)); }
.cards-of-gallery a { display: flex; flex-direction: column; border: .05rem solid #8886; border-radius: .3rem;
  overflow: hidden; color: inherit; }
.cards-of-gallery a:hover { border-color: var(--md-accent-fg-color, #526cfe); }
.cards-of-gallery img { width: 100%; height: 7.5rem; padding: .4rem; object-fit: contain; background: #fff;
  box-sizing: border-box; }
.cards-of-gallery strong, .cards-of-gallery span { margin: .35rem .5rem 0; font-size: .7rem; line-height: 1.35; }
.cards-of-gallery span { margin: .1rem .5rem .5rem; font-size: .62rem; opacity: .8; }
</style>
"""
FRAME = '<iframe src="{}" class="report" title="{}" loading="lazy"></iframe>'
#: Within a page of the gallery, which has its title and its command line, a report shows its player at once.
FRAMED = """<style>
.framed .page-header, .framed footer { display: none; }
.framed .figure:first-of-type .picture { max-height: 54vh; }
</style>
<script>if (top !== self) document.documentElement.classList.add('framed');</script>
</body>"""


def keys_of(data: dict[str, Any], table: str) -> set[str]:
    """The keys of all items of a table."""
    items = data.get(table, [])
    rows = items.values() if isinstance(items, dict) else items
    return {key for row in rows if isinstance(row, dict) for key in row}


def first_comment(text: str) -> list[str]:
    """The lines of the comment that a file begins with, without their marks."""
    lines = []
    for line in text.split("\n"):
        if not line.startswith("#"):
            break
        lines.append(line[1:].removeprefix(" "))
    return lines


def as_html(lines: list[str]) -> str:
    """A comment as paragraphs; what is indented in it keeps its lines."""
    def words(text: str) -> str:
        return re.sub(r"`([^`]*)`", r"<code>\1</code>", html.escape(text, quote=False))

    out: list[str] = []
    block: list[str] = []
    indented = False

    def flush() -> None:
        if block and indented:
            out.append("<pre><code>" + html.escape("\n".join(block), quote=False) + "</code></pre>")
        elif block:
            out.append("<p>" + words(" ".join(block)) + "</p>")
        block.clear()

    for line in lines:
        if not line.strip():
            flush()
            continue
        if line.startswith("  ") != indented:
            flush()
            indented = line.startswith("  ")
        block.append(line.rstrip() if indented else line.strip())
    flush()
    return "\n".join(out)


def sentences_of_readme() -> dict[str, str]:
    """What datasets/README.md says that each file shows; of designs it says what is asked for."""
    out = {}
    for line in (DATASETS / "README.md").read_text(encoding="utf-8").split("\n"):
        cells = [cell.strip() for cell in line.strip("|").split("|")]
        found = re.fullmatch(r"`([\w/]+\.toml)`", cells[0])
        if found and len(cells) > 2 and not cells[1].startswith("`"):
            out[found[1]] = cells[1]
    return out


class Dataset:
    """A file of datasets/ with the command lines that show it."""

    def __init__(self, name: str, lines: list[str], said: str | None) -> None:
        self.name = name
        self.file = DATASETS / name
        self.text = self.file.read_text(encoding="utf-8")
        self.data = tomllib.loads(self.text)
        self.slug = name.removesuffix(".toml")
        #: Every report is of a line that is run after those before it.
        self.runs = [tuple(lines[:k + 1]) for k in range(len(lines))]
        self.title = str(self.data.get("title", self.data.get("kind", self.file.stem.replace("_", " ").capitalize())))
        comment = " ".join(first_comment(self.text))
        self.said = said or re.split(r"(?<=[.:;]) (?=[A-Z])", comment)[0].rstrip(":;")

    @property
    def up(self) -> str:
        """From the folder of its page to that of all pages."""
        return "../" * (self.slug.count("/") + 1)

    @property
    def beside(self) -> str:
        """From the folder of its page to that of the gallery."""
        return "../" * self.slug.count("/")

    def sentence(self) -> str:
        text = re.sub(r"`([^`]*)`", r"\1", self.said).rstrip(".")
        return html.escape(text[:1].upper() + text[1:], quote=False) + "."


def groups_of_table() -> list[tuple[str, list[Dataset]]]:
    """The groups of gallery.toml."""
    said = sentences_of_readme()
    table = tomllib.loads(TABLE.read_text(encoding="utf-8"))
    groups = [(str(group["title"]), [Dataset(name, lines, said.get(name)) for name, lines in group["shows"].items()])
              for group in table["group"]]
    titles: set[str] = set()
    for dataset in (dataset for _, datasets in groups for dataset in datasets):
        if dataset.title in titles:
            dataset.title += f" ({dataset.slug})"
        titles.add(dataset.title)
    return groups


def cases_of(dataset: Dataset) -> Iterator[str]:
    """The cases of a file of hard cases, as a table."""
    yield from ("## Cases", "", "| case | what is hard | scene |", "| --- | --- | --- |")
    for case in dataset.data["case"]:
        scene = f"{case.get('series', '')}, {case.get('size', '')}"
        if "scene" in case:
            name = (dataset.file.parent / case["scene"]).resolve().relative_to(DATASETS).as_posix()
            scene = f"[{name}]({dataset.beside}{name.removesuffix('.toml')}.md)"
        yield f"| `{case['name']}` | {commands.escaped(case['title'])} | {scene} |"
    yield ""


class Gallery:
    """Writes the pages of all datasets, each with its reports beside it."""

    def __init__(self, folder: pathlib.Path, reports: Reports) -> None:
        self.folder = folder
        self.reports = reports
        #: Where each report is written: one that several pages show is written once.
        self.places: dict[tuple[str, ...], str] = {}

    def write_report(self, dataset: Dataset, run: tuple[str, ...], number: int) -> dict[str, Any]:
        """Writes the report of a run, unless another page has it; returns its document."""
        source = self.reports.file_of(run)
        page = source.read_text(encoding="utf-8").replace("</body>", FRAMED)
        if len(page.encode()) >= LARGEST:
            raise ReportError(f"{run[-1]}: a report of {len(page.encode())} bytes; expected fewer than {LARGEST}")
        if run not in self.places:
            self.places[run] = f"{dataset.slug}/report{number or ''}.html"
            (self.folder / self.places[run]).write_text(page, encoding="utf-8")
        return document_of(page)

    def see_also(self, dataset: Dataset) -> str:
        """Links to the pages that explain what a file has and what is run."""
        links = [f"[{word}]({dataset.up}{page})" for word, page, has in FEATURES if has(dataset.data)]
        names = dict.fromkeys(run[-1].split()[1] for run in dataset.runs)
        links += [f"[poise {name}]({dataset.up}commands/{name}.md)" for name in names]
        links += [f"[{commands.title_of_doc(guide)}]({dataset.up}{guide}.md)"
                  for name in names for guide in commands.GUIDES[name][:1]]
        return ", ".join(dict.fromkeys(links))

    def write(self, dataset: Dataset) -> None:
        """Writes the page of a dataset, with its picture, its reports and its files."""
        folder = self.folder / dataset.slug
        folder.mkdir(parents=True, exist_ok=True)
        documents = [self.write_report(dataset, run, k) for k, run in enumerate(dataset.runs)]
        moving = [document for document in documents if figure_that_plays(document) is not None]
        if not moving:
            raise ReportError(f"{dataset.name}: nothing moves in the reports of {[run[-1] for run in dataset.runs]}")
        (folder / "picture.svg").write_text(picture_of(moving[0]), encoding="utf-8")
        beside = dataset.file.parent
        files = sorted(file.relative_to(beside) for file in named_files("datasets/" + dataset.name)
                       if beside in file.parents)
        for file in files:
            (folder / file).parent.mkdir(exist_ok=True)
            shutil.copyfile(beside / file, folder / file)
        lines = ["---", f"title: {json.dumps(dataset.title)}", "hide: [navigation, toc]", "---", "",
                 f"# {commands.escaped(dataset.title)}", "", f"<p>{dataset.sentence()}</p>", ""]
        for run in dataset.runs:
            place = dataset.beside + self.places[run]
            lines += ["```console", f"$ {run[-1]} --html report.html", "```", "",
                      FRAME.format(place, html.escape(run[-1])), "",
                      f'<a href="{place}" target="_blank">The report by itself</a>', ""]
        if "case" in dataset.data:
            lines += cases_of(dataset)
        own = dataset.file.stem
        links = ", ".join(f'<a href="{own}/{file}" download>{file}</a>' for file in files)
        lines += ["## The file", "", as_html(first_comment(dataset.text)), "", f"<p>{links}</p>", "",
                  "See " + self.see_also(dataset) + ".", "",
                  "````toml", dataset.text.rstrip("\n"), "````", ""]
        folder.with_name(f"{folder.name}.md").write_text("\n".join(lines), encoding="utf-8")


def cards(datasets: list[Dataset]) -> str:
    """Cards with links to the pages of datasets."""
    def card(dataset: Dataset) -> str:
        return (f'<a href="{dataset.slug}.html"><img src="{dataset.slug}/picture.svg" alt="" loading="lazy">'
                f"<strong>{html.escape(dataset.title, quote=False)}</strong><span>{dataset.sentence()}</span></a>")

    return '<div class="cards-of-gallery">\n' + "\n".join(card(dataset) for dataset in datasets) + "\n</div>\n"


INTRODUCTION = """\
Every mechanism of `datasets/`, moved by the command that shows it best. Press play in a report or drag its slider: each
is one file that `poise COMMAND --html FILE` writes. What makes a scene hard to solve is in the [hard cases](hard.md).
"""
HARD_INTRODUCTION = """\
The scenes and cases on which `poise stress` runs every method ([results](../stress.md)): each has an answer that is
known independently of Poise. They are moved here over the place that is hard, as far as they can move.
"""


def is_hard(datasets: list[Dataset]) -> bool:
    return datasets[0].name.startswith("hard/")


def index(title: str, introduction: str, groups: list[tuple[str, list[Dataset]]]) -> str:
    """A page with the cards of all groups."""
    parts = [f"## {group}\n\n{cards(datasets)}" for group, datasets in groups]
    return "\n".join([f"---\nhide: [navigation]\n---\n\n# {title}\n", STYLE, introduction, *parts])


def navigation(groups: list[tuple[str, list[Dataset]]]) -> list[Any]:
    return [{group: [f"gallery/{dataset.slug}.md" for dataset in datasets]} for group, datasets in groups]


def write_pages(pages: pathlib.Path, build: pathlib.Path) -> list[Any]:
    """Writes the pages and returns their part of the navigation."""
    begin = time.monotonic()
    groups = groups_of_table()
    every = [dataset for _, datasets in groups for dataset in datasets]
    runs = list(dict.fromkeys(run for dataset in every for run in dataset.runs))
    reports = Reports(build / "poise", build / "reports")
    reports.make_all(runs)
    reports.forget_others(runs)
    gallery = Gallery(pages / "gallery", reports)
    faults = []
    for dataset in every:
        try:
            gallery.write(dataset)
        except ReportError as error:
            faults.append(str(error))
    if faults:
        raise ReportError("\n".join(faults))
    general = [group for group in groups if not is_hard(group[1])]
    hard = [group for group in groups if is_hard(group[1])]
    (gallery.folder / "index.md").write_text(index("Gallery", INTRODUCTION, general), encoding="utf-8")
    (gallery.folder / "hard.md").write_text(index("Hard cases", HARD_INTRODUCTION, hard), encoding="utf-8")
    print(f"gallery: {len(every)} datasets, {len(runs)} reports in {time.monotonic() - begin:.1f} s")
    return [{"Gallery": ["gallery/index.md", *navigation(general),
                         {"Hard cases": ["gallery/hard.md", *navigation(hard)]}]}]


if __name__ == "__main__":
    write_pages(pathlib.Path(sys.argv[2]), pathlib.Path(sys.argv[1]).resolve())
