"""The examples that come with the package: scenes, experiments, designs and their data."""

from __future__ import annotations

import pathlib
import re
import tomllib
from typing import Any

from . import _poise
from ._scene import Scene, load
from ._tables import EXAMPLES, checked_name, shown, unknown


def _files() -> dict[str, pathlib.Path]:
    """All files that calls read, by their place in the folder; without the ending .toml. Others, which describe the
    examples or have their known answers, are none of them."""
    files = (file for file in sorted(EXAMPLES.rglob("*")) if file.suffix in (".toml", ".csv", ".svg"))
    return {file.relative_to(EXAMPLES).as_posix().removesuffix(".toml"): file for file in files}


def _document(file: pathlib.Path) -> dict[str, Any]:
    return tomllib.loads(file.read_text(encoding="utf-8"))


def _listed(files: dict[str, pathlib.Path]) -> list[str]:
    """The names of all files of TOML but those in hard/, with which `poise stress` tries the methods."""
    return [name for name, file in files.items() if file.suffix == ".toml" and not name.startswith("hard/")]


def _bare(name: str) -> str:
    """A name without its folder and its ending, in small letters."""
    return name.rpartition("/")[2].partition(".")[0].lower()


def _unknown(name: str, files: dict[str, pathlib.Path]) -> _poise.InputError:
    """The error of a name that is none: folder, ending or capitals may be missing or wrong, and letters too."""
    near = re.search('"(.+)"', _poise.did_you_mean(_bare(name), sorted({_bare(known) for known in files})))
    alike = [f'"{known}"' for known in files if near is not None and _bare(known) == near[1]]
    if alike:
        return _poise.InputError(f"{shown(name)}: expected the name of an example; did you mean {' or '.join(alike)}?")
    return unknown("the name of an example", name, _listed(files))


def examples() -> dict[str, str]:
    """The examples that come with Poise: their titles by name. `example` loads a scene by its name, `example_path` is
    the file of any of them.

    >>> import poise
    >>> poise.examples()["toggle_clamp"]
    'Toggle clamp'
    >>> [name for name in poise.examples() if name.startswith("lift")][:3]
    ['lift', 'lift_design', 'lift_experiment']
    """
    files = _files()
    titles = {name: _document(files[name]).get("title") for name in _listed(files)}
    return {name: str(title) for name, title in titles.items() if title is not None}


def example_path(name: str) -> pathlib.Path:
    """The file of an example, for calls that read files; that of a scene may be copied and changed. Other files that
    come with the examples have their ending in the name. Raises InputError for a name that is none, with the nearest.

    >>> import poise
    >>> poise.identifiability(poise.example_path("lift_experiment")).code
    0
    >>> poise.example_path("struts.csv").name
    'struts.csv'
    """
    files = _files()  # no name leads out of the folder
    file = files.get(checked_name(name).removesuffix(".toml"))
    if file is None or (name.endswith(".toml") and file.suffix != ".toml"):
        raise _unknown(name, files)
    return file


def example(name: str) -> Scene:
    """Load a scene that comes with Poise, by its name: `examples` has the names of all.

    Raises InputError for a name that is none, with the nearest, and for that of an experiment or a design, whose file
    other calls read.

    >>> import poise
    >>> clamp = poise.example("toggle_clamp")
    >>> clamp.solve().verdict
    'In equilibrium, proved: stable.'
    """
    file = example_path(name)
    if file.suffix != ".toml" or "body" not in _document(file):
        raise _poise.InputError(f'{name}: expected the name of a scene; poise.example_path("{name}") is this file, '
                                "for calls that read it")
    return load(file)
