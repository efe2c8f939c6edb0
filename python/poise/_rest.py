"""Where a scene comes to rest."""

from __future__ import annotations

from typing import Any, Iterator, Sequence

import numpy as np

from . import _pictures, _poise
from ._found import Core, Found
from ._tables import Array, ByName, checked_name, frozen, needed, si_unit


class Family(ByName[float]):
    """Quantities of one kind by what they are of: ``rest.angle["arm"]`` is ``rest["angle.arm"]``."""

    def __init__(self, rest: Rest, family: str) -> None:
        self._rest = rest
        self._family = family

    def __getitem__(self, name: str) -> float:
        value: float = self._rest[f"{self._family}.{name}"]
        return value

    def __iter__(self) -> Iterator[str]:
        begin = self._family + "."
        return (name[len(begin):] for name in self._rest.keys() if name.startswith(begin))

    def __len__(self) -> int:
        return sum(1 for _ in self)

    def __contains__(self, name: object) -> bool:
        return isinstance(name, str) and name in list(self)

    def __repr__(self) -> str:
        return repr(dict(self))


class Why(str):
    """How a search ended, in a sentence; called with the name of a quantity, why that has no value."""

    _rest: Rest

    def __call__(self, name: str) -> str:
        """Why a quantity is undefined, in a sentence; "" where it has a value. Raises InputError for unknown names."""
        return str(self._rest._core.value(checked_name(name))[3])


class Rest(Found):
    """Where a scene comes to rest: a position, what is proved of it, and every quantity there by its name.

    ``rest["angle.arm"]``, ``rest.angle["arm"]``, ``rest["push.handle.grip.x"]``: the names of docs/quantities.md, in
    the units of the scene, nan where a quantity is undefined (``rest.why(name)`` says why). ``rest.si`` is a view of
    the same in SI units. Unknown names raise InputError with the nearest. That no equilibrium was found is no
    exception: ``rest.found`` is False, ``rest.status`` and ``rest.why`` say more.

    >>> import poise
    >>> clamp = poise.load("datasets/toggle_clamp.toml")
    >>> rest = clamp.solve(P=25)
    >>> rest.found, rest.proved, rest.stability
    (True, True, 'stable')
    >>> round(rest.force["rubber"], 3), rest.unit("force.rubber")
    (-724.538, 'N')
    >>> round(rest.si.angle["arm"], 6), rest.si.unit("angle.arm")
    (0.002192, 'rad')
    >>> rest["push.handle.grip.x"], rest.why("push.handle.grip.x")
    (nan, 'nothing can move')
    """

    _core: Any
    _answer: Core | None = None
    _again = None

    def __init__(self, core: _poise.Rest) -> None:
        self._core = core

    def _outcome(self) -> Core:
        if self._answer is None:
            self._answer = self._core.outcome(False)
        return self._answer

    def _with_pictures(self) -> Core:
        if self._pictured is None:
            self._pictured = self._core.outcome(True)
        return self._pictured

    # What is known of the search.

    @property
    def code(self) -> int:
        """0 where an equilibrium was found as it was asked for, else 1."""
        return int(self._outcome().code)

    def __bool__(self) -> bool:
        return bool(self._core.found)

    @property
    def found(self) -> bool:
        """There is a position: proved, or, without a proof, checked by free bodies."""
        return bool(self._core.found)

    @property
    def proved(self) -> bool | None:
        """An equilibrium is proved (docs/certificate.md); None where that was not asked for (``proof=False``)."""
        proved: bool | None = self._core.proved
        return proved

    @property
    def radius(self) -> float | None:
        """Exactly one equilibrium is this close, in rad or lengths over the size; None where nothing is proved."""
        radius: float | None = self._core.radius
        return radius

    @property
    def status(self) -> str:
        """confirmed (proved), checked, not proved, went elsewhere, not found, interrupted (``status`` of docs/json.md).
        """
        return str(self._core.status)

    @property
    def why(self) -> Why:
        """How the search ended, in a sentence. ``rest.why(name)`` is why a quantity has no value, "" where it has."""
        out = Why(self._core.why)
        out._rest = self
        return out

    @property
    def stability(self) -> str | None:
        """stable, unstable, neutral, unknown; None where no equilibrium is proved."""
        stability: str | None = self._core.stability
        return stability

    @property
    def x(self) -> Array:
        """The coordinates of the compiled model, shape (n,), float64: angles in rad, lengths in the unit of the scene;
        ``Scene.coordinates`` names them, and ``Scene.equations`` is zero there, with limits that are ``touching``.
        Places of points are ``rest["x.arm.T"]`` and ``rest.point["arm.T"]``."""
        return frozen(self._core.x)

    @property
    def touching(self) -> dict[str, str]:
        """The stops that are touched, and at which limit: ``{"over_centre": "min"}``."""
        touching: dict[str, str] = self._core.touching
        return touching

    @property
    def scene(self) -> Any:
        """The scene that was solved, with the numbers that were given."""
        from ._scene import Scene

        return Scene(self._core.scene)

    # Quantities.

    def __getitem__(self, name: str) -> Any:
        """The value of a quantity, nan where it is undefined; of ``push.BODY.POINT`` and ``center.A.B``, which have two
        directions, the array of both, [x, y]. Raises InputError for a name that is none."""
        if checked_name(name).startswith(("push.", "center.")) and f"{name}.x" in self._core.scene.quantities:
            return frozen(np.array([self[f"{name}.x"], self[f"{name}.y"]]))
        value, _, in_si, _ = self._core.value(name)
        return float(value * in_si if self._in_si else value)

    def unit(self, name: str) -> str:
        """The unit of a quantity, "" of a pure number. Raises InputError for a name that is none."""
        unit = str(self._core.value(checked_name(name))[1])
        return si_unit(unit)[0] if self._in_si else unit

    def keys(self) -> Sequence[str]:
        """The names of the quantities that its items have; expressions of them are understood too."""
        return [name for name in self._core.scene.quantities if not name.startswith("fold.")]

    def values(self) -> Iterator[float]:
        """Their values."""
        return (self[name] for name in self.keys())

    def items(self) -> Iterator[tuple[str, float]]:
        """Their names and values."""
        return ((name, self[name]) for name in self.keys())

    def __iter__(self) -> Iterator[str]:
        return iter(self.keys())

    def __contains__(self, name: object) -> bool:
        return isinstance(name, str) and name in self.keys()

    @property
    def energy(self) -> float:
        """Potential energy; its zero is arbitrary."""
        return float(self["energy"])

    @property
    def point(self) -> Points:
        """Places of points in the world: ``rest.point["arm.T"]`` is an array [x, y]."""
        return Points(self)

    @property
    def angle(self) -> Family:
        """Angles of bodies in the world, unwrapped: ``rest.angle["arm"]``."""
        return Family(self, "angle")

    @property
    def travel(self) -> Family:
        """Travels of slides and of pins in slots."""
        return Family(self, "travel")

    @property
    def length(self) -> Family:
        """Lengths, or angles, that force elements act on."""
        return Family(self, "length")

    @property
    def force(self) -> Family:
        """Forces of elements that store energy, or torques; positive in tension."""
        return Family(self, "force")

    @property
    def rate(self) -> Family:
        """How fast these forces change with the length or angle."""
        return Family(self, "rate")

    @property
    def reaction(self) -> Family:
        """Sizes of the forces of joints: ``rest.reaction["B"]``, parts of them: ``["B.x"]``, ``["B.y"]``."""
        return Family(self, "reaction")

    @property
    def stop(self) -> Family:
        """Forces or torques with which stops push; 0 where they do not touch."""
        return Family(self, "stop")

    @property
    def shaking(self) -> Family:
        """Force on the ground: ``x``, ``y``, ``size``, ``moment``."""
        return Family(self, "shaking")

    @property
    def push(self) -> Family:
        """Hand forces: ``rest.push["handle.grip.x"]``."""
        return Family(self, "push")

    @property
    def center(self) -> Family:
        """Instant centres: ``rest.center["arm.ground.x"]``."""
        return Family(self, "center")

    @property
    def transmission(self) -> Family:
        """Transmission angles: ``rest.transmission["link.B"]``."""
        return Family(self, "transmission")

    @property
    def mode(self) -> Family:
        """Small vibrations: ``rest.mode["1.frequency"]``, ``["1.damping"]``."""
        return Family(self, "mode")

    @property
    def stress(self) -> Family:
        """Largest sizes of the stress in links with a section."""
        return Family(self, "stress")

    def to_frame(self, table: str | None = None) -> Any:
        """A pandas DataFrame of all quantities by name: ``value`` (nan where it is undefined), ``unit``, ``why``; or of
        one of ``tables``."""
        if table is not None:
            return super().to_frame(table)
        pandas = needed("pandas", "python3-pandas", "to_frame()")
        names = self.keys()
        rows = [(self[name], self.unit(name), self.why(name)) for name in names]
        return pandas.DataFrame(rows, index=names, columns=["value", "unit", "why"])

    def plot(self, ax: Any = None) -> Any:
        """The mechanism in its position, as matplotlib axes in the scene's unit of length, in which other things can be
        drawn; ``svg`` is the drawing of the command line."""
        return _pictures.plot_positions([self._known], [""], str(self._known["units"]["length"]), ax)

    def __reduce__(self) -> Any:
        core = self._core
        options = {"method": core.method, "seek": core.seek, "time": core.time, "proof_seconds": core.proof_seconds}
        given = {name: value for name, value in options.items() if value is not None}
        scene = (core.scene.text, core.scene.name, core.scene.changes)
        return (_solved, (scene, dict(given, proof=core.proved is not None), self._in_si))


class Points(ByName[Array]):
    """Places of the points of moving bodies by "BODY.POINT", arrays [x, y]."""

    def __init__(self, rest: Rest) -> None:
        self._rest = rest

    def __getitem__(self, name: str) -> Array:
        return frozen(np.array([self._rest[f"x.{name}"], self._rest[f"y.{name}"]]))

    def __iter__(self) -> Iterator[str]:
        return (name[2:] for name in self._rest.keys() if name.startswith("x."))

    def __len__(self) -> int:
        return sum(1 for _ in self)


def _solved(scene: tuple[str, str, list[tuple[str, float]]], options: dict[str, Any], in_si: bool) -> Rest:
    """Solves it again, which gives the same bits."""
    out = Rest(_poise.Scene.parse(*scene).solve(**options))
    return out.si if in_si else out
