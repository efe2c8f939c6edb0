"""Examples in the docstrings run and print what they show, in a folder that has datasets/."""

import doctest
import importlib
import pkgutil
from pathlib import Path

import poise
import pytest

SOURCE = Path(__file__).resolve().parents[2]
MODULES = ["poise"] + [f"poise.{module.name}" for module in pkgutil.iter_modules(poise.__path__)]
OPTIONS = doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE


@pytest.mark.parametrize("name", MODULES)
def test_examples_print_what_they_show(name, tmp_path, monkeypatch):
    (tmp_path / "datasets").symlink_to(SOURCE / "datasets")
    monkeypatch.chdir(tmp_path)
    result = doctest.testmod(importlib.import_module(name), extraglobs={"poise": poise}, optionflags=OPTIONS)
    assert result.failed == 0


def test_everything_public_is_described():
    """Every public name has a docstring, and every method and property of a public class."""
    missing = []
    for name in poise.__all__:
        thing = getattr(poise, name)
        if not getattr(thing, "__doc__", None):
            missing.append(name)
        if not isinstance(thing, type):
            continue
        for kind in thing.__mro__:
            if not kind.__module__.startswith("poise"):
                continue
            for key, member in vars(kind).items():
                described = isinstance(member, (property, staticmethod, classmethod)) or callable(member)
                if described and not key.startswith("_") and not member.__doc__:
                    missing.append(f"{kind.__name__}.{key}")
    assert not missing, ", ".join(sorted(set(missing)))
