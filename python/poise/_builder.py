"""Scenes built in Python."""

from __future__ import annotations

from typing import Any, Mapping, Sequence, SupportsFloat, Union

from . import _poise
from ._poise import Measure
from ._scene import Scene
from ._tables import refuse_mask

#: Two numbers: a tuple, a list or an array of shape (2,).
Pair = Union[Sequence[SupportsFloat], Any]
#: Pairs of numbers: a list of them or an array of shape (n, 2).
Pairs = Union[Sequence[Pair], Any]
#: A part of the law of a cam: up to the angle ``to`` of a law ("dwell", "harmonic", "cycloidal", "polynomial_345"), at
#: which the lift is this share, or that of the part before where there is none: (to, law) or (to, law, lift).
CamPart = Union[tuple[SupportsFloat, str], tuple[SupportsFloat, str, Union[SupportsFloat, None]]]
#: What a rope touches: a point, or a pulley (point, radius, turn) round which it turns "clockwise" or
#: "counterclockwise".
RopePoint = Union[str, tuple[str, SupportsFloat, str]]


class SceneBuilder:
    """Builds a scene in code, as docs/scene-files.md describes scene files: the same items, keys, units, defaults and
    checks, for ``build()`` hands all of it to the reader of scene files.

    All numbers are in these units and those that follow from them (docs/scene-files.md#units), time in seconds. Each
    method returns the builder. Points are named "BODY.POINT", those of the ground "ground.POINT". Items may refer to
    what is added later. An empty name stands for the default: "a.P-b.Q" of a joint, the kind and a number of anything
    else ("spring 1").

    Keys of a table of a scene file are keywords: numbers, texts (of a number an expression), True or False, two numbers
    or expressions, pairs of numbers, dictionaries for tables in that table, lists of dictionaries for lists of tables.
    ``from_`` is the key ``from``.

    >>> import poise
    >>> from poise import measures
    >>> press = (
    ...     poise.SceneBuilder("press", length="mm", angle="deg")
    ...     .gravity((0, -9810))
    ...     .ground_point("O", (0, 0))
    ...     .body("crank", {"O": (0, 0), "B": (120, 0)}, mass=0.4, center=(60, 0))
    ...     .pin("ground.O", "crank.O")
    ...     .element("torsion_spring", "return", measures.angle("ground", "crank"), stiffness=20, free_angle=80)
    ...     .start("crank", 40)
    ...     .build()
    ... )
    >>> round(press.solve().angle["crank"], 3)
    77.44

    Bad input raises InputError in the words of the reader of files, with the title in place of file and line: what an
    item needs by itself where it is added, everything else by ``build()``.
    """

    __slots__ = ("_core", "_title")

    def __init__(self, title: str, *, length: str = "m", force: str = "N", mass: str = "kg",
                 angle: str = "rad") -> None:
        self._title = title
        try:
            self._core = _poise.SceneBuilder(title, length, force, mass, angle)
        except (TypeError, UnicodeEncodeError):
            raise _poise.InputError(f"SceneBuilder: expected a title and the names of units, "
                                    f"found {(title, length, force, mass, angle)!r:.200}") from None

    def _add(self, item: str, *given: object) -> SceneBuilder:
        refuse_mask(f"{self._title}: {item}", given)
        try:
            getattr(self._core, item)(*given)
        except (TypeError, UnicodeEncodeError):
            raise _poise.InputError(f"{self._title}: {item}: expected what help(poise.SceneBuilder.{item}) names, "
                                    f"found {', '.join(repr(one) for one in given):.200}") from None
        return self

    @staticmethod
    def _keys(keys: Mapping[str, Any]) -> dict[str, Any]:
        """Names of keys, of which those that are words of Python have an underscore at the end."""
        return {key[:-1] if key.endswith("_") else key: value for key, value in keys.items()}

    # What all scenes have.

    def source(self, text: str, /) -> SceneBuilder:
        """Where the data come from."""
        return self._add("source", text)

    def number(self, name: str, value: SupportsFloat | str, /) -> SceneBuilder:
        """A number that expressions refer to, or, as a text, one that is such an expression itself
        (docs/scene-files.md#expressions)."""
        return self._add("number", name, value)

    def gravity(self, acceleration: Pair, /) -> SceneBuilder:
        """The acceleration of gravity (x, y)."""
        return self._add("gravity", acceleration)

    def frame(self, axis: str, /, **keys: Any) -> SceneBuilder:
        """The place of the fixed frame along ``"x"`` or ``"y"`` as a function of time, ``function="0.1*sin(3*t)"``;
        ``as_="acceleration"`` says that it is that."""
        return self._add("frame", axis, self._keys(keys))

    def ground_point(self, name: str, at: Pair, /) -> SceneBuilder:
        """A point of the ground."""
        return self._add("ground_point", name, at)

    def body(self, name: str, points: Mapping[str, Pair] | None = None, *, mass: SupportsFloat = 0.0,
             center: Pair = (0.0, 0.0), inertia: SupportsFloat = 0.0) -> SceneBuilder:
        """A body with its points in its own frame, its mass, its centre of mass there, and its inertia about that."""
        return self._add("body", name, {} if points is None else points, mass, center, inertia)

    def section(self, body: str, /, line: Sequence[str] = (), **keys: Any) -> SceneBuilder:
        """The section of a body that was added before, with its ``area``, ``second_moment``, ``modulus``, ``height``,
        ``left`` and ``profile``, and the points of its line in order; both points of a body that has two where none are
        given."""
        return self._add("section", body, line, self._keys(keys))

    def start(self, name: str, value: SupportsFloat, /) -> SceneBuilder:
        """A guess for the absolute angle of a body, or for the travel of a joint."""
        return self._add("start", name, value)

    def start_position(self, body: str, at: Pair, /) -> SceneBuilder:
        """A guess for the place of a body's origin in the world."""
        return self._add("start_position", body, at)

    def output(self, name: str, quantity: str, /) -> SceneBuilder:
        """A quantity with a name of its own, an expression of the names of docs/quantities.md."""
        return self._add("output", name, quantity)

    def part(self, file: str, /, name: str = "", **keys: Any) -> SceneBuilder:
        """The items of a scene file, under the name of the part (docs/scene-files.md#parts): ``at``, ``angle``,
        ``mirror``, ``scale``, ``on``, ``repeat``, ``step``, ``turn``, and the dictionaries ``join``, ``join_next`` and
        ``numbers``. The file counts from the current folder."""
        return self._add("part", file, self._keys(keys), name)

    # Joints of two points of different bodies. The axis is fixed in the first body; only its direction counts. The
    # angle is what angle(second body) - angle(first body) stays.

    def pin(self, a: str, b: str, /, name: str = "") -> SceneBuilder:
        """A pin of two points."""
        return self._add("pin", a, b, name)

    def slide(self, a: str, b: str, /, axis: Pair, name: str = "", angle: SupportsFloat = 0.0) -> SceneBuilder:
        """A slide along an axis that is fixed in the body of ``a``, at an angle that stays."""
        return self._add("slide", a, b, axis, name, angle)

    def pin_in_slot(self, a: str, b: str, /, axis: Pair, name: str = "") -> SceneBuilder:
        """A pin ``b`` in a straight slot through ``a``."""
        return self._add("pin_in_slot", a, b, axis, name)

    def weld(self, a: str, b: str, /, angle: SupportsFloat = 0.0, name: str = "") -> SceneBuilder:
        """Two bodies that are one."""
        return self._add("weld", a, b, angle, name)

    def bar(self, a: str, b: str, /, length: SupportsFloat, name: str = "") -> SceneBuilder:
        """A distance that stays."""
        return self._add("bar", a, b, length, name)

    def friction(self, **keys: Any) -> SceneBuilder:
        """Friction of the joint that was added last: ``coefficient``, ``radius`` and ``torque`` of a pin,
        ``coefficient``, ``length`` and ``force`` of a slide, ``coefficient`` and ``force`` of a pin in a slot."""
        return self._add("friction", self._keys(keys))

    # Elements, drives and stops.

    def element(self, table: str, name: str, on: Measure, /, **keys: Any) -> SceneBuilder:
        """A force element with the keys of its table in docs/scene-files.md#force-elements: ``"spring"``,
        ``"torsion_spring"``, ``"cubic_spring"``, ``"constant_force"``, ``"damper"``, ``"torsion_damper"``,
        ``"friction"``, ``"bump_stop"``, ``"motor"``, ``"controller"``. Dampers may have a ``drag`` or, as springs,
        a curve. A controller may act on ``measures.nothing()``; ``reads={"slide": "rail"}`` is what it reads."""
        return self._add("element", table, name, on, self._keys(keys))

    def drive(self, name: str, on: Measure, /, **keys: Any) -> SceneBuilder:
        """A drive with its ``start``, ``rate``, ``acceleration``, ``amplitude``, ``frequency``, ``phase``."""
        return self._add("drive", name, on, self._keys(keys))

    def stop(self, name: str, on: Measure, /, **keys: Any) -> SceneBuilder:
        """A stop with its ``min``, ``max`` or both; ``stiffness``, ``damping`` and ``exponent`` of one that yields."""
        return self._add("stop", name, on, self._keys(keys))

    def blade(self, at: str, /, name: str = "", **keys: Any) -> SceneBuilder:
        """A blade under a point: ``angle`` of its edge in the point's body, and the body ``on`` which it stands."""
        return self._add("blade", at, self._keys(keys), name)

    # Gears, cams, ropes, chains, slots, rolling wheels and profiles, whose tables docs/gears-cams-ropes.md,
    # docs/curved-slots.md and docs/rolling-profiles.md describe.

    def gear(self, a: str, b: str, /, name: str = "", **keys: Any) -> SceneBuilder:
        """Gears on two bodies: ``ratio``, ``carrier``, ``internal``, ..."""
        return self._add("gear", a, b, self._keys(keys), name)

    def belt(self, a: str, b: str, /, name: str = "", **keys: Any) -> SceneBuilder:
        """A belt round two bodies: ``ratio``, ``crossed``, ..."""
        return self._add("belt", a, b, self._keys(keys), name)

    def rack(self, slide: str, pinion: str, /, name: str = "", **keys: Any) -> SceneBuilder:
        """A rack, which is a slide, and its pinion, a body: ``radius``, ..."""
        return self._add("rack", slide, pinion, self._keys(keys), name)

    def geneva(self, crank: str, wheel: str, /, name: str = "", **keys: Any) -> SceneBuilder:
        """A Geneva drive of a crank and a wheel: ``slots``, ``phase``, ``offset``, ..."""
        return self._add("geneva", crank, wheel, self._keys(keys), name)

    def coupling(self, sum: Measure, /, name: str = "", **keys: Any) -> SceneBuilder:
        """A sum of measures, measures.sum(...), held at its ``value``."""
        return self._add("coupling", sum, self._keys(keys), name)

    def cam(self, a: str, b: str, /, follower: Measure, law: Sequence[CamPart] = (), name: str = "",
            **keys: Any) -> SceneBuilder:
        """A cam whose angle is that of body ``b`` from body ``a``; the profile is this law, or a key ``curve`` where it
        has no parts: ``lift``, ``base``, ..."""
        return self._add("cam", a, b, follower, law, self._keys(keys), name)

    def rope(self, over: Sequence[RopePoint], /, name: str = "", **keys: Any) -> SceneBuilder:
        """A rope over points and pulleys: ``length``, or ``stiffness`` and ``free_length``."""
        return self._add("rope", over, self._keys(keys), name)

    def chain(self, a: str, b: str, /, name: str = "", **keys: Any) -> SceneBuilder:
        """A chain round two sprockets: ``radius_a``, ``radius_b``, ``turn``, ..."""
        return self._add("chain", a, b, self._keys(keys), name)

    def loose_pin(self, a: str, b: str, /, name: str = "", **keys: Any) -> SceneBuilder:
        """A pin in a hole that is wider than it: ``clearance``."""
        return self._add("loose_pin", a, b, self._keys(keys), name)

    def loose_slot(self, a: str, b: str, /, axis: Pair, name: str = "", **keys: Any) -> SceneBuilder:
        """A pin, the point ``b``, in a slot along an axis of the body of ``a`` that is wider than it: ``clearance``."""
        return self._add("loose_slot", a, b, axis, self._keys(keys), name)

    def contact(self, point: str, way: Sequence[str], /, name: str = "", **keys: Any) -> SceneBuilder:
        """A point of a body, or a circle of ``radius`` around it, that touches the way through points of another one on
        the left of it: a segment of two, or an outline of more, ``closed`` or not."""
        return self._add("contact", point, way, self._keys(keys), name)

    def contact_of_outlines(self, outline: Sequence[str], against: Sequence[str], /, name: str = "",
                            **keys: Any) -> SceneBuilder:
        """Outlines of two bodies that touch each other, with the contact on the left of both: ``closed`` of the first,
        ``against_closed`` of the other."""
        return self._add("contact_of_outlines", outline, against, self._keys(keys), name)

    def contact_with_arc(self, point: str, center: str, from_: str, to: str, /, name: str = "", hollow: bool = False,
                         **keys: Any) -> SceneBuilder:
        """The same of an arc around ``center``, clockwise from one point to another; counter-clockwise, with the
        contact inside, of a ``hollow`` one."""
        return self._add("contact_with_arc", point, center, from_, to, hollow, self._keys(keys), name)

    def circular_slot(self, pin: str, center: str, /, name: str = "", **keys: Any) -> SceneBuilder:
        """A pin in a slot of a circle: ``radius``, ``from_``, ``to``."""
        return self._add("circular_slot", pin, center, self._keys(keys), name)

    def curved_slot(self, pin: str, at: str, /, curve: Pairs, name: str = "", **keys: Any) -> SceneBuilder:
        """A pin in a slot along a curve, which is fixed in the body of the point ``at``: ``closed``, ..."""
        return self._add("curved_slot", pin, at, curve, self._keys(keys), name)

    def rolling(self, wheel: str, line: str, /, axis: Pair, name: str = "", **keys: Any) -> SceneBuilder:
        """A wheel that rolls on a line: ``radius``, ..."""
        return self._add("rolling", wheel, line, axis, self._keys(keys), name)

    def rolling_on_circle(self, wheel: str, center: str, /, name: str = "", **keys: Any) -> SceneBuilder:
        """A wheel that rolls on a circle: ``radius``, ``circle_radius``, ``inside``, ..."""
        return self._add("rolling_on_circle", wheel, center, self._keys(keys), name)

    def rolling_profile(self, at: str, /, curve: Pairs, line: str, axis: Pair, name: str = "",
                        **keys: Any) -> SceneBuilder:
        """A curve, fixed in the body of the point ``at``, that rolls on a line."""
        return self._add("rolling_profile", at, curve, line, axis, self._keys(keys), name)

    def rolling_profile_on_circle(self, at: str, /, curve: Pairs, center: str, name: str = "",
                                  **keys: Any) -> SceneBuilder:
        """A curve, fixed in the body of the point ``at``, that rolls on a circle: ``circle_radius``, ..."""
        return self._add("rolling_profile_on_circle", at, curve, center, self._keys(keys), name)

    def curve_contact(self, at: str, /, curve: Pairs, against: str, against_curve: Pairs, name: str = "",
                      **keys: Any) -> SceneBuilder:
        """Convex curves of two bodies that stay outside of one another: ``radius``, ``restitution``, ..."""
        return self._add("curve_contact", at, curve, against, against_curve, self._keys(keys), name)

    # Loads.

    def force(self, name: str, at: str, vector: Pair, *, follows: str = "") -> SceneBuilder:
        """A force at a point, which keeps its direction in the world, or in the body that it ``follows``."""
        return self._add("force", name, at, vector, follows)

    def force_along(self, name: str, at: str, direction: Pair, size: SupportsFloat, *,
                    follows: str = "") -> SceneBuilder:
        """One that has its direction at every size, 0 too."""
        return self._add("force_along", name, at, direction, size, follows)

    def distributed_load(self, name: str, a: str, b: str, vector: Pair, *, follows: str = "") -> SceneBuilder:
        """A force per length on the straight line between two points of one body."""
        return self._add("distributed_load", name, a, b, vector, follows)

    def distributed_load_along(self, name: str, a: str, b: str, direction: Pair, size: SupportsFloat, *,
                               follows: str = "") -> SceneBuilder:
        """One that has its direction at every size, 0 too."""
        return self._add("distributed_load_along", name, a, b, direction, size, follows)

    def torque(self, name: str, body: str, value: SupportsFloat, /) -> SceneBuilder:
        """A torque on a body from the ground, counter-clockwise positive."""
        return self._add("torque", name, body, value)

    # The scene.

    @property
    def toml(self) -> str:
        """What was added, as a scene file. Items are not checked."""
        return self._core.text()

    def build(self) -> Scene:
        """The scene. Raises InputError: ``press: spring "return".points: expected a point of "crank", found "crank.C";
        did you mean "crank.O"?``. A name that a body, a point or a guess has already is refused when the second one is
        added."""
        return Scene(self._core.build())

    def __repr__(self) -> str:
        return f"<builder of {self._title}>"
