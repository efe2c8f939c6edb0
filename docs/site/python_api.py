"""Pages of the Python reference: the public names of the module poise, with their signatures and docstrings.

Signatures are those of python/poise/*.py, and of _poise.pyi for what is compiled, whose docstrings the module has.
"""

from __future__ import annotations

import ast
import dataclasses
import functools
import inspect
import re
import sys
from pathlib import Path
from typing import Any, Iterator, Sequence

import plain_text
from pygments.lexers import PythonLexer

PACKAGE = Path(__file__).resolve().parents[2] / "python" / "poise"
LEXER = PythonLexer()


@dataclasses.dataclass
class Page:
    """Names that are described together. A name "module.Name" is shown as Name, "A=B" has the members of B shown as
    those of A."""

    name: str
    title: str
    about: str
    names: list[str]


PAGES = [
    Page("scenes", "Scenes", "Read a scene, change its numbers, and find an equilibrium. A scene has its "
         "[commands](commands.md), [many variants](many.md) and [equations](equations.md) as methods too.",
         ["_scene.load", "_examples.example", "_examples.examples", "_examples.example_path", "_scene.Scene",
          "_view.View"]),
    Page("results", "Results", "What calls return. A result never changes, is true where what was asked for is found "
         "and confirmed, and has its numbers by name.",
         ["_rest.Rest", "_rest.Why", "_rest.Family", "_rest.Points", "_found.Found", "_found.Columned", "_found.Curve",
          "_found.PathPoint", "_found.Branch", "_found.Equilibria", "_found.Position", "_found.Motion",
          "_found.Tolerance", "_found.Band", "_tables.Table", "_tables.Record"]),
    Page("commands", "Commands as calls", "Every command of `poise --help` as a call; those that read a scene are "
         "methods of `Scene`.",
         ["Scene=_commands.SceneCommands", "_commands.design", "_commands.stress", "_commands.import_"]),
    Page("identification", "Identification", "Parameters from measured motion.",
         ["_experiment.Experiment", "_commands.identify", "_commands.identifiability", "_commands.validate",
          "_commands.plan", "_commands.montecarlo", "_found.Fit", "_found.Estimate", "_tables.Matrix"]),
    Page("many", "Many variants", "Arrays of numbers make as many [variants](../batches.md) of a scene.",
         ["Scene=_many.Batches", "_many.Many", "_many.ManyPaths"]),
    Page("builder", "Building scenes", "Scenes in Python, with the items and keys of [scene files](../scene-files.md).",
         ["_builder.SceneBuilder", "measures.angle", "measures.distance", "measures.travel", "measures.x", "measures.y",
          "measures.sum"]),
    Page("equations", "Equations for other solvers", "The equations of equilibrium, their derivatives, and the proof "
         "of a place that another program found.",
         ["Scene=_numerics.Equations", "_poise.System", "_poise.Certificate"]),
    Page("errors", "Errors", "Bad input is an exception. That nothing was found is none: ask the result.",
         ["_poise.InputError"]),
]
INTRODUCTION = """[Poise in Python](../python.md) shows how the module `poise` is used; here is every name of it.
Numbers are in the units of the scene, arrays are NumPy's. Where a shape is named, n is the number of coordinates, m
that of the rows that hold."""
#: Classes of which users make objects by calling them.
MADE = ("SceneBuilder", "Experiment")
#: How users write what calls these.
CALLED = {"__getitem__": "{}[name]", "__call__": "{}(name)", "__bool__": "bool({})", "__float__": "float({})",
          "__len__": "len({})", "__iter__": "iter({})"}


@functools.cache
def definition(module: str, name: str) -> ast.ClassDef | ast.FunctionDef:
    """From the file of a module, or from the stub of what is compiled."""
    file = PACKAGE / f"{module}.py"
    tree = ast.parse((file if file.exists() else file.with_suffix(".pyi")).read_text())
    return [node for node in tree.body if isinstance(node, (ast.ClassDef, ast.FunctionDef)) and node.name == name][-1]


def arguments_of(of: ast.FunctionDef, bound: bool) -> list[str]:
    """As they are written, without the self of what is bound to an object."""
    listed = of.args
    positional = [*listed.posonlyargs, *listed.args]
    defaults: list[ast.expr | None] = [*[None] * (len(positional) - len(listed.defaults)), *listed.defaults]

    def shown(one: ast.arg, default: ast.expr | None, stars: str = "") -> str:
        value = "" if default is None else f"{' = ' if one.annotation else '='}{ast.unparse(default)}"
        return stars + one.arg + (f": {ast.unparse(one.annotation)}" if one.annotation else "") + value

    out = [shown(*pair) for pair in zip(positional, defaults)]
    if len(listed.posonlyargs) > bound:
        out.insert(len(listed.posonlyargs), "/")
    if listed.vararg:
        out.append(shown(listed.vararg, None, "*"))
    elif listed.kwonlyargs:
        out.append("*")
    out += [shown(*pair) for pair in zip(listed.kwonlyargs, listed.kw_defaults)]
    if listed.kwarg:
        out.append(shown(listed.kwarg, None, "**"))
    return out[1:] if bound else out


def signature_of(name: str, of: ast.FunctionDef, bound: bool) -> str:
    """A call with its arguments, each in a line of its own where they are long; of a property its type."""
    returns = ast.unparse(of.returns) if of.returns else ""
    if "property" in decorators(of):
        return f"{name}: {returns}"
    arguments = arguments_of(of, bound and "staticmethod" not in decorators(of))
    line = f"{name}({', '.join(arguments)})"
    if len(line) > 100:
        line = f"{name}(\n" + "".join(f"    {one},\n" for one in arguments) + ")"
    return f"{line} -> {returns}" if returns else line


def decorators(of: ast.FunctionDef) -> list[str]:
    return [ast.unparse(one) for one in of.decorator_list]


def docstring(text: str, arguments: Sequence[str]) -> str:
    """A docstring in the form that plain_text takes: what it says of arguments as a list."""
    text = re.sub(r"::$", ":", inspect.cleandoc(text), flags=re.M)
    out, listing = [], False
    for line in text.split("\n"):
        name = re.match(r"([a-z]\w*(?:, [a-z]\w*)*): (.*)", line)
        if name and set(name.group(1).split(", ")) <= set(arguments):
            out += [] if listing else [""]
            line, listing = f"- `{name.group(1)}`: {name.group(2)}", True
        elif listing and not line.startswith("    "):
            listing = False
            out.append("")
        out.append(line)
    return "\n".join(out)


class Reference:
    """Where each name stands, and the pages."""

    def __init__(self, compiled: Any) -> None:
        self.compiled = compiled
        self.places: dict[str, str] = {}
        self.members: dict[str, list[ast.FunctionDef]] = {}  # of classes
        self.page = ""
        self.scope = ""  # the class that is described
        self.arguments: list[str] = []  # of the function that is described
        self.count = self.without_words = 0
        for page in PAGES:
            for entry in page.names:
                shown, name = self.names(entry)
                self.places.setdefault(shown, f"{page.name}.md#{shown}")
                node = definition(*name)
                for member in public_members(node) if isinstance(node, ast.ClassDef) else []:
                    self.places.setdefault(f"{shown}.{member.name}", f"{page.name}.md#{anchor_of(shown, member)}")
        for alias in aliases():
            self.places[alias] = f"index.md#{alias}"

    @staticmethod
    def names(entry: str) -> tuple[str, tuple[str, str]]:
        """What is shown, and module and name of what describes it."""
        shown, _, described = entry.rpartition("=")
        module, _, name = described.rpartition(".")
        return shown or (f"measures.{name}" if module == "measures" else name), (module, name)

    def link(self, name: str) -> str | None:
        if name.startswith("docs/"):
            return "../" + name.removeprefix("docs/")
        if name in self.arguments:
            return None
        name = name.removesuffix("()").removeprefix("poise.")
        place = self.places.get(f"{self.scope}.{name}") or self.places.get(name)
        return place and place.removeprefix(self.page)

    def words(self, text: str | None, arguments: Sequence[str] = ()) -> str:
        self.count += 1
        self.without_words += not text
        self.arguments = list(arguments)
        words = plain_text.markdown(docstring(text or "", arguments), self.link)
        self.arguments = []
        return words

    def block(self, text: str) -> str:
        def address(name: str) -> str | None:
            is_type = name[0].isupper()
            return (self.link(name) or "").replace(".md#", ".html#") if is_type else None

        return plain_text.signatures([plain_text.signature(text, LEXER, address)])

    def function(self, shown: str, node: ast.FunctionDef, text: str | None, bound: bool) -> list[str]:
        names = [one.arg for one in [*node.args.posonlyargs, *node.args.args, *node.args.kwonlyargs]]
        keywords = re.findall(r"^(\w+): ", inspect.cleandoc(text or ""), re.M) if node.args.kwarg else []
        return [self.block(signature_of(shown, node, bound)), self.words(text, [*names, *keywords])]

    def entry(self, entry: str) -> Iterator[str]:
        shown, (module, name) = self.names(entry)
        node = definition(module, name)
        self.scope = shown
        text = getattr(self.compiled, name).__doc__ if module == "_poise" else ast.get_docstring(node)
        if isinstance(node, ast.FunctionDef):
            yield f"## {shown} {{#{shown}}}"
            yield from self.function(f"poise.{shown}", node, text, bound=False)
            return
        if shown == name:
            yield f"## {shown} {{#{shown}}}"
            bases = [name for base in node.bases if (name := ast.unparse(base)) in self.places]
            begin = [one for one in node.body if isinstance(one, ast.FunctionDef) and one.name == "__init__"]
            if shown in MADE:
                yield self.block(signature_of(f"poise.{shown}", begin[0], bound=True).removesuffix(" -> None"))
            else:
                yield self.block(f"class {shown}" + (f"({', '.join(bases)})" if bases else ""))
            yield self.words(text)
        elif text:
            yield self.words(text)
        for member in public_members(node):
            said = ast.get_docstring(member)
            if module == "_poise":
                said = re.sub(r"^.*-> .*\n\n", "", getattr(getattr(self.compiled, name), member.name).__doc__ or "")
            called = CALLED.get(member.name, "").format(shown.lower())
            yield f"### {plain_text.escape(called or f'{shown}.{member.name}')} {{#{anchor_of(shown, member)}}}"
            yield from self.function(member.name, member, said, bound=True)

    def write(self, page: Page, folder: Path) -> None:
        self.page = f"{page.name}.md"
        parts = [f"# {page.title}", page.about]
        for entry in page.names:
            parts += self.entry(entry)
        (folder / self.page).write_text("\n\n".join(part for part in parts if part) + "\n")

    def write_index(self, folder: Path) -> None:
        self.page, self.scope = "index.md", ""
        rows = ["| page | names |", "| --- | --- |"]
        for page in PAGES:
            names: list[str] = []
            for entry in page.names:
                shown, (module, name) = self.names(entry)
                node = definition(module, name)
                names += [f"{shown}.{member.name}" for member in public_members(node)
                          ] if "=" in entry and isinstance(node, ast.ClassDef) else [shown]
            links = ", ".join(f"[`{name}`]({self.link(name)})" for name in names)
            rows.append(f"| [{page.title}]({page.name}.md) | {links} |")
        parts = ["# Reference of Python", INTRODUCTION, "\n".join(rows), "## Types of arguments"]
        for name, text in aliases().items():
            parts.append(f"`{name}`{{#{name}}}: {plain_text.prose(text, self.link)}")
        (folder / self.page).write_text("\n\n".join(parts) + "\n")


def anchor_of(shown: str, member: ast.FunctionDef) -> str:
    """Without the underscores of special methods, which Markdown would read as emphasis."""
    return f"{shown}.{member.name.strip('_')}"


def public_members(of: ast.ClassDef) -> list[ast.FunctionDef]:
    members = [node for node in of.body if isinstance(node, ast.FunctionDef) and "overload" not in decorators(node)]
    return [node for node in members
            if not node.name.startswith("_") or (node.name in CALLED and ast.get_docstring(node))]


def aliases() -> dict[str, str]:
    """Names of types, with the comment that stands above each."""
    found = {}
    alias = re.compile(r"^((?:#: .*\n)+)([A-Z][a-z]\w*) = ", re.M)
    for module in ("_run", "_builder", "_experiment"):
        for comment, name in alias.findall((PACKAGE / f"{module}.py").read_text()):
            found[name] = comment.replace("#: ", "").replace("\n", " ")
    return dict(sorted(found.items()))


def write_pages(pages: Path, build: Path) -> list[Any]:
    sys.path.insert(0, str(build / "python"))
    import poise

    described = {Reference.names(entry)[0].partition(".")[0] for page in PAGES for entry in page.names}
    missing = set(poise.__all__) - described
    if missing:
        raise SystemExit(f"docs/site/python_api.py: expected the public name {min(missing)} on one of the pages")
    reference = Reference(poise._poise)
    folder = pages / "python"
    folder.mkdir(parents=True, exist_ok=True)
    reference.write_index(folder)
    for page in PAGES:
        reference.write(page, folder)
    print(f"Python: {reference.count} names, {reference.without_words} of them without a docstring")
    return [{"Reference of Python": ["python/index.md", *({page.title: f"python/{page.name}.md"} for page in PAGES)]}]


if __name__ == "__main__":
    write_pages(Path(sys.argv[2]), Path(sys.argv[1]))
