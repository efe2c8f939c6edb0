"""Scenes, and what can be asked of them."""

from __future__ import annotations

import os
import pathlib
from typing import Any, Mapping, SupportsFloat

import numpy as np

from . import _poise
from ._commands import SceneCommands
from ._many import Batches
from ._numerics import Equations
from ._rest import Rest
from ._tables import checked_name, checked_text, refuse_mask, write_file
from ._view import View, view


class Scene(SceneCommands, Equations, Batches):
    """A mechanism, as a scene file describes it (docs/scene-files.md). It never changes: `with_numbers` gives another.

    Every command that reads a scene is a method of it; numbers are in the units of the scene.

    >>> import poise
    >>> clamp = poise.load("datasets/toggle_clamp.toml")
    >>> clamp.numbers["load.P"], clamp.unit("load.P")
    (25.0, 'N')
    >>> clamp.with_numbers(P=38).solve()["force.rubber"]
    0.0
    """

    __slots__ = ("_core",)

    def __new__(cls, title: Any, **units: str) -> Any:
        """``Scene(title, length="mm", ...)`` begins a `SceneBuilder`, whose ``build()`` gives the scene."""
        if isinstance(title, _poise.Scene):
            return super().__new__(cls)
        from ._builder import SceneBuilder

        if isinstance(title, str) and title.endswith(".toml"):
            raise _poise.InputError(f"Scene: expected a title, found {title!r:.200}; poise.load() reads a file")
        return SceneBuilder(title, **units)

    def __init__(self, core: Any, **units: str) -> None:
        self._core: _poise.Scene = core

    def solve(self, *numbers: dict[str, Any], **options: Any) -> Rest:
        """Find an equilibrium and the forces in it, by one method: the command solve.

        ``numbers`` is a dictionary of numbers, {"load.P": 25}. Keywords are numbers too, by path or by the end of the
        path that only one number has (``P=25``), and these options:

        method: of docs/method.md, ``"virtual-work"`` where none is given
        seek: ``"settle"`` (where it settles when released from its start), ``"any"``, ``"stable"``
        time: s, at which loads that follow functions of time are taken
        proof: False leaves out the proof; ``rest.proved`` is None then
        proof_seconds: time allowed for the proof

        Raises InputError for unknown names. That nothing was found is no exception: ``rest.status`` says it.
        """
        refuse_mask("solve", [*numbers, options])
        proof = options.get("proof")
        if options.get("proof_seconds") is not None and isinstance(proof, (bool, np.bool_)) and not proof:
            raise _poise.InputError("proof_seconds: expected none with proof=False, with which nothing is proved")
        return Rest(self._core.solve(*numbers, **options))

    def with_numbers(self, *numbers: Mapping[str, SupportsFloat], **named: SupportsFloat) -> Scene:
        """The scene with these numbers changed, as ``solve()`` takes them. Raises InputError for unknown names, and for
        values out of their range."""
        changes: dict[str, Any] = {}
        refuse_mask("with_numbers", [*numbers, named])
        for one in numbers:
            if not isinstance(one, Mapping):
                raise _poise.InputError('with_numbers: expected a dictionary of numbers, {"load.P": 25}, '
                                        f"found {one!r:.200}")
            changes.update(one)
        return Scene(self._core.with_numbers({**changes, **named}))

    @property
    def name(self) -> str:
        """The file that it was read from, or the title of one that was built."""
        return self._core.name

    @property
    def title(self) -> str:
        """Its title."""
        return self._core.title

    @property
    def numbers(self) -> dict[str, float]:
        """All numbers by path (docs/scene-files.md), in the units of the scene."""
        return self._core.numbers

    @property
    def changes(self) -> dict[str, float]:
        """The numbers that were changed since it was read."""
        return dict(self._core.changes)

    def unit(self, name: str) -> str:
        """The unit of a number; "" of one without. Raises InputError for unknown names."""
        return self._core.unit_of(checked_name(name))

    @property
    def quantities(self) -> list[str]:
        """The names of what can be asked of it at rest (docs/quantities.md)."""
        return self._core.quantities

    @property
    def toml(self) -> str:
        """The text of its file, with the changed numbers written in; comments and layout stay."""
        return self._core.written()

    def save(self, file: str | os.PathLike[str]) -> None:
        """Writes ``toml`` to a file. Raises InputError where that cannot be written."""
        write_file(pathlib.Path(file), self.toml)

    def __repr__(self) -> str:
        numbers = "".join(f", {path} = {value:g}" for path, value in self._core.changes)
        return f"<{self.title or 'scene'} ({self.name}{numbers})>"

    def _repr_mimebundle_(self, include: Any = None, exclude: Any = None) -> dict[str, str]:
        """What a notebook shows: the mechanism as it is assembled, and what it is."""
        return self.check()._repr_mimebundle_(include, exclude)

    def view(
        self, *, origin: str | None = None, port: int = 0, browser: bool | None = None, height: int = 700
    ) -> View:
        """The live page of it, in a notebook's cell or in the browser: the command view.

        origin: of the notebook, which alone may show the page in a frame, as the browser's address bar has it,
            ``"http://localhost:8888"``; where none is given, that of the notebook server that runs this kernel on this
            machine. Where none is known (a remote kernel), the cell shows the page of the equilibrium without a server.
        port: of 127.0.0.1 to listen on; 0: any that is free
        browser: True opens the page in the browser; where nothing is given that is done outside of notebooks
        height: of the frame, px

        Raises InputError for a scene that does not settle, for what is no origin and for a port that cannot be had.
        """
        return view(self, origin=origin, port=port, browser=browser, height=height)

    def _state(self) -> tuple[str, str, list[tuple[str, float]]]:
        return (self._core.text, self._core.name, self._core.changes)

    def __eq__(self, other: object) -> bool:
        """Scenes are equal that were read from the same text under the same name and have the same numbers changed."""
        if not isinstance(other, Scene):
            return NotImplemented
        text, name, changes = self._state()
        return (text, name) == other._state()[:2] and dict(changes) == dict(other._state()[2])

    def __hash__(self) -> int:
        return hash(self._state()[:2])

    def __reduce__(self) -> Any:
        return (_read_again, self._state())

    def __copy__(self) -> Scene:
        return self

    def __deepcopy__(self, memo: Any) -> Scene:
        return self


def _read_again(text: str, name: str, changes: list[tuple[str, float]]) -> Scene:
    return Scene(_poise.Scene.parse(text, name, changes))


def load(file: str | os.PathLike[str]) -> Scene:
    """Read a scene file. Raises InputError, one line with file, line, item and what was expected."""
    name = os.fspath(file)
    return Scene(_poise.Scene.load(checked_text(name) if isinstance(name, str) else name))
