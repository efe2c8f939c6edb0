"""Pages of the site for the commands of ``poise --help``, from the table that the command line is read by.

    /usr/bin/python3 docs/site/commands.py BUILD PAGES

writes PAGES/commands/index.md and PAGES/commands/NAME.md of every command.
"""

from __future__ import annotations

import pathlib
import re
import subprocess
import sys
from typing import Any

DOCS = pathlib.Path(__file__).resolve().parents[1]

#: The pages of docs/ that show what a command does, the first at length.
GUIDES = {
    "check": ["scene-files", "tutorial"],
    "solve": ["tutorial", "method"],
    "equilibria": ["equilibria"],
    "hold": ["friction"],
    "view": ["view"],
    "path": ["load-paths", "recipes"],
    "find": ["find"],
    "sensitivity": ["sensitivity"],
    "tolerance": ["sensitivity", "tutorial"],
    "loads": ["loads"],
    "compare": ["method", "performance"],
    "kinematics": ["motion", "quantities"],
    "motion": ["motion", "tutorial-identification"],
    "modes": ["motion", "recipes"],
    "response": ["response", "motion"],
    "running": ["running"],
    "forces": ["motion", "friction"],
    "equations": ["equations", "motion"],
    "design": ["design-recipes", "design-files", "synthesis", "path-synthesis", "balance"],
    "identify": ["experiment-files", "tutorial-identification"],
    "validate": ["experiment-files", "tutorial-identification"],
    "identifiability": ["tutorial-identification", "experiment-files"],
    "plan": ["planning"],
    "montecarlo": ["studies"],
    "import": ["exchange"],
    "export": ["exchange"],
    "stress": ["hard-cases", "stress", "safeguards"],
}
#: Options that every command with a result has.
OUTPUTS = ("--json", "--csv", "--markdown", "--svg", "--html", "--quiet", "--verbose")

Entry = dict[str, Any]


def entries_of(build: pathlib.Path) -> list[Entry]:
    """The table of the command line, from the Python module of a build folder."""
    sys.path.insert(0, str(build / "python"))
    from poise import _poise
    return [dict(entry) for entry in _poise.commands()]


def title_of_doc(name: str) -> str:
    first = (DOCS / f"{name}.md").read_text(encoding="utf-8").split("\n", 1)[0]
    return first.lstrip("# ").replace("`", "")


def with_links(text: str) -> str:
    """A page of docs/ that a text names becomes a link to it."""
    return re.sub(r"\bdocs/([a-z-]+)\.md", lambda found: f"[{title_of_doc(found[1])}](../{found[1]}.md)", text)


def escaped(text: str) -> str:
    """Text as Markdown shows it, in the cell of a table."""
    return re.sub(r"([\\`*_{}\[\]<>|])", r"\\\1", text)


def meaning(option: Entry) -> str:
    """The help of an option in one line, but for lists, which have a line for each name."""
    lines = option["help"].split("\n")
    names = [re.match(r"[a-z-]+: ", line) is not None for line in lines]
    text = with_links(escaped(lines[0]))
    for line, is_name in zip(lines[1:], names[1:]):
        word, rest = line.split(": ", 1) if is_name else ("", line)
        if is_name and sum(names) > 2:
            text += f"<br>`{word}`: {with_links(escaped(rest))}"
        else:
            text += " " + with_links(escaped(line))
    return text


def as_written(option: Entry) -> str:
    return f"{option['name']} {option['value']}".rstrip()


def table(head: str, options: list[Entry]) -> list[str]:
    if not options:
        return []
    rows = [f"| `{as_written(o)}` | {'**Required.** ' if o['required'] else ''}{meaning(o)} |" for o in options]
    return [f"| {head} | meaning |", "| --- | --- |", *rows, ""]


def usage(entry: Entry) -> str:
    words = [as_written(o) for o in entry["options"] if o["required"]]
    open_words = [o["name"] for o in entry["options"] if not o["required"] and not o["name"].startswith("-")]
    return " ".join(["poise", entry["name"], *words, *(f"[{word}]" for word in open_words), "[OPTIONS]"])


def page(entry: Entry) -> str:
    options = entry["options"]
    outputs = [o for o in options if o["name"] in OUTPUTS]
    others = [o for o in options if o not in outputs]
    guides = ", ".join(f"[{title_of_doc(name)}](../{name}.md)" for name in GUIDES[entry["name"]])
    lines = [f"# poise {entry['name']}", "", escaped(entry["help"]) + ".", "",
             "```console", f"$ {usage(entry)}", "```", "",
             *table("option", others),
             *table("output", outputs),
             "## Example", "", "```console", f"$ poise {entry['name']} {entry['example']}", "```", "",
             f"It is shown in {guides}.", ""]
    return "\n".join(lines)


def exit_codes(build: pathlib.Path) -> str:
    """The words of the help about exit codes and what follows them."""
    text = subprocess.run([build / "poise", "--help"], capture_output=True, text=True, check=True).stdout
    found = re.search(r"^Exit code:.*?(?=\n\n|\Z)", text, re.DOTALL | re.MULTILINE)
    assert found is not None, "the help says nothing of exit codes"
    return escaped(" ".join(found[0].split()))


def index(entries: list[Entry], codes: str) -> str:
    rows = [f"| [poise {entry['name']}]({entry['name']}.md) | {escaped(entry['help'])} |" for entry in entries]
    return "\n".join(["# Commands", "",
                      "`poise --help` and `poise COMMAND --help` print the same. `poise --version` prints the version.",
                      "", "| command | what it does |", "| --- | --- |", *rows, "", codes, ""])


def write_pages(pages: pathlib.Path, build: pathlib.Path) -> list[Any]:
    """Writes the pages and returns their part of the navigation."""
    folder = pages / "commands"
    folder.mkdir(parents=True, exist_ok=True)
    entries = entries_of(build)
    (folder / "index.md").write_text(index(entries, exit_codes(build)), encoding="utf-8")
    for entry in entries:
        (folder / f"{entry['name']}.md").write_text(page(entry), encoding="utf-8")
    names = [{f"poise {entry['name']}": f"commands/{entry['name']}.md"} for entry in entries]
    return [{"Commands": ["commands/index.md", *names]}]


if __name__ == "__main__":
    write_pages(pathlib.Path(sys.argv[2]), pathlib.Path(sys.argv[1]).resolve())
