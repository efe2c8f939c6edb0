"""Writes python/poise/_commands.py: every command of ``poise --help`` as a call, from the table of the command line.

    PYTHONPATH=build/python python3 -P python/generate_commands.py

The rules are those of python/poise/_run.py.
"""

from __future__ import annotations

import keyword
import pathlib
import textwrap

from poise import _poise
from poise._found import FOUND_CLASSES
from poise._run import LEFT_OUT_OPTIONS, call_of

FILE = pathlib.Path(__file__).with_name("poise") / "_commands.py"
HAND_WRITTEN = ("solve", "view")

#: Types by what the help calls a value, of options that are texts or lists.
TYPES = {
    "NAME=FROM..TO": "Ranges",
    "NAME[=FROM..TO]": "Ranges",
    "NAME[=RANGE]": "Ranges",
    "NAME[=VALUE]": "Ranges",
    "PATH=NUMBER": "Settings",
    "NAME=NUMBER": "Settings",
    '"Q = VALUE"': "Settings",
    "LABEL: SETTINGS": "Variants",
    "NUMBERS": "Numbers",
    "RANGE": "Numbers",
    "NAMES": "Words",
    "FILE": "Path",
    "DIR": "Path",
    "OTHER": "Path | Sequence[Path]",
}
TYPES_OF_OPTIONS = {
    "--tolerances FILE": "Path | Mapping[str, Any]",
    "--continue FILE": "Path | Found",
    "--with FILE": "Path | Found",
    "--motion FILE": "Path | Found",
}
#: What is known of these besides their help.
ALSO = {
    "NAME=FROM..TO": "or a dictionary, {NAME: (FROM, TO)}",
    "NAME[=FROM..TO]": "or a dictionary, {NAME: (FROM, TO)} or {NAME: None}",
    "NAME[=RANGE]": "or a dictionary, {NAME: (FROM, TO)}, {NAME: NUMBER} or {NAME: None}",
    "NAME[=VALUE]": "or a dictionary, {NAME: NUMBER} or {NAME: None}",
    "PATH=NUMBER": "or a dictionary, {PATH: NUMBER}",
    "NAME=NUMBER": "or a dictionary, {NAME: NUMBER}",
    '"Q = VALUE"': "or a dictionary, {Q: VALUE}",
    "LABEL: SETTINGS": "or a dictionary, {LABEL: {PATH: NUMBER}}",
    "NUMBERS": "or a row of numbers",
    "RANGE": "or a row of numbers",
    "--tolerances FILE": "or a dictionary, {PATH: NUMBER}",
    "--with FILE": "or the fit itself",
    "--motion FILE": "or the motion itself",
    "EXPERIMENT ": "or an Experiment",
}
#: What may be given without its name although it may be left out.
FIRST_BUT_OPTIONAL = ("--tolerances FILE",)
RANGED = ("NAME=FROM..TO", "NAME[=FROM..TO]", "NAME[=RANGE]")

HEAD = '''"""The commands of ``poise --help`` as calls: written by python/generate_commands.py, not by hand.

What is common to all of them: options that are None are not given. Numbers are in the units of the scene. ``progress``
is called with a text that says what is being done, ten times a second at most. Ctrl-C stops the work of a call in the
main thread, which returns what it has. Bad input raises InputError, in the one line that the command line prints; that
nothing was found is no exception but said by the result.
"""

from __future__ import annotations

from typing import Any, Mapping, Sequence

from . import _poise
from ._found import {classes}
from ._run import {types}

'''


def parameter_of(option: _poise.Option, taken: set[str]) -> str:
    """The name of an option in Python, which is none of those that are taken."""
    name = option["name"].lstrip("-").lower().replace("-", "_")
    return name + "_" if keyword.iskeyword(name) or name in taken else name


def type_of(option: _poise.Option) -> str:
    name, kind, value = option["name"], option["kind"], option["value"]
    if kind == "flag":
        return "bool"
    if kind == "whole number":
        return "int"
    if kind == "number":
        return "float"
    if name == "EXPERIMENT":
        return "ExperimentFile | Sequence[ExperimentFile]" if kind == "list" else "ExperimentFile"
    if name in ("DESIGN", "FILE"):
        return "Path"
    plain = "Words" if kind == "list" else "str"
    return TYPES_OF_OPTIONS.get(f"{name} {value}", TYPES.get(value, plain))


class CommandCall:
    """A command as a function or method: its parameters in their order."""

    def __init__(self, entry: _poise.Command) -> None:
        self.entry = entry
        self.reads_scene = any(option["name"] == "SCENE" for option in entry["options"])
        self.options = [o for o in entry["options"] if o["name"] not in (*LEFT_OUT_OPTIONS, "SCENE")]
        self.ranged = next((o for o in self.options if o["value"] in RANGED), None)
        taken = {o["name"].lower() for o in self.options if not o["name"].startswith("-")}
        if self.ranged is not None:
            taken |= {"name", "low", "high"}
        self.parameters = [(parameter_of(o, taken if o["name"].startswith("-") else set()), o) for o in self.options]

    @property
    def name(self) -> str:
        return call_of(self.entry["name"])

    @property
    def kind(self) -> str:
        return FOUND_CLASSES[self.entry["name"]].__name__ if self.entry["name"] in FOUND_CLASSES else "Found"

    def is_first(self, option: _poise.Option) -> bool:
        """Whether an option may be given without its name: what is required, and words that have none."""
        name = option["name"]
        is_first = option["required"] or not name.startswith("-") or f"{name} {option['value']}" in FIRST_BUT_OPTIONAL
        return is_first and option is not self.ranged

    def signature(self) -> list[str]:
        first = ["self"] if self.reads_scene else []
        if self.ranged is not None:
            first += ["name: str | None = None", "low: float | None = None", "high: float | None = None"]
        rest = []
        needs = self.ranged is None
        for name, option in self.parameters:
            hint = type_of(option)
            if self.is_first(option):
                needed = needs = needs and option["required"]
                first.append(f"{name}: {hint}" if needed else f"{name}: {hint} | None = None")
            else:
                rest.append(f"{name}: bool = False" if hint == "bool" else f"{name}: {hint} | None = None")
        return [*first, "*", *rest, "progress: Progress | None = None"]

    def docstring(self, blanks: str) -> list[str]:
        entry = self.entry
        width = 116 - len(blanks)
        example = textwrap.wrap(f"poise {entry['name']} {entry['example']}", width - 2, break_long_words=False,
                                break_on_hyphens=False)
        out = [f'{blanks}"""{entry["help"]}.', "",
               f"{blanks}As by the command line::", "",
               *(f"{blanks}    {line} \\" for line in example[:-1]), f"{blanks}    {example[-1]}", ""]
        if self.ranged is not None:
            out.append(f"{blanks}name, low, high: a range of ``{parameter_of(self.ranged, set())}``, without the word")
        for name, option in self.parameters:
            lines = option["help"].split("\n")
            also = ALSO.get(f"{option['name']} {option['value']}", ALSO.get(option["value"]))
            if also is not None:
                lines[-1] += ";"
                lines.append(also)
            out.append(f"{blanks}{name}: {lines[0]}")
            out += [f"{blanks}    {line}" for line in lines[1:]]
        return [*out, f'{blanks}"""']

    def text(self) -> str:
        blanks = "    " * (2 if self.reads_scene else 1)
        outer = blanks[4:]
        scene = "self._core" if self.reads_scene else "None"
        ranged = "None" if self.ranged is None else f'("{self.ranged["name"]}", name, low, high)'
        lines = [f"{outer}def {self.name}("]
        lines += [f"{blanks}{parameter}," for parameter in self.signature()]
        lines.append(f"{outer}) -> {self.kind}:")
        lines += self.docstring(blanks)
        lines.append(f'{blanks}return run({self.kind}, "{self.entry["name"]}", {scene}, {{')
        lines += [f'{blanks}    "{option["name"]}": {name},' for name, option in self.parameters]
        lines.append(f"{blanks}}}, {ranged}, progress)")
        return "\n".join(lines) + "\n"


def text() -> str:
    """The whole file."""
    calls = [CommandCall(entry) for entry in _poise.commands() if entry["name"] not in HAND_WRITTEN]
    methods = [call.text() for call in calls if call.reads_scene]
    functions = [call.text() for call in calls if not call.reads_scene]
    body = ('class SceneCommands:\n    """The commands that read a scene."""\n\n    __slots__ = ()\n\n'
            "    _core: _poise.Scene\n\n" + "\n".join(methods) + "\n\n" + "\n\n".join(functions))
    types = ("ExperimentFile", "Numbers", "Path", "Progress", "Ranges", "Settings", "Variants", "Words", "run")
    classes = sorted({"Found"} | {call.kind for call in calls})
    names = "".join(f'    "{call.name}",\n' for call in calls if not call.reads_scene)
    end = f"\n\n#: The commands that are functions.\nFUNCTIONS = (\n{names})\n"
    return HEAD.format(classes=", ".join(classes), types=", ".join(types)) + "\n" + body + end


if __name__ == "__main__":
    FILE.write_text(text(), encoding="utf-8")
