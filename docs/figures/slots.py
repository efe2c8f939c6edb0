"""Drawings of curved-slots.md and rolling-profiles.md, from the geometry of slots, wheels and profiles."""

from __future__ import annotations

import cmath
import math
from collections.abc import Sequence

import numpy as np
from drawing import Drawing, Panel, turned
from scipy.interpolate import CubicSpline


class Curve:
    """The cubic spline through points over the sum of their chords, as Poise has it."""

    def __init__(self, points: Sequence[complex], is_closed: bool = False, ends: str = "natural") -> None:
        self.points = list(points)
        through = np.array(self.points + self.points[:1] if is_closed else self.points)
        self.along = np.concatenate([[0], np.cumsum(np.abs(np.diff(through)))])
        self.spline = CubicSpline(self.along, through, bc_type="periodic" if is_closed else ends)

    @property
    def chords(self) -> float:
        return float(self.along[-1])

    def at(self, s: float) -> complex:
        return complex(self.spline(s))

    def tangent(self, s: float) -> complex:
        slope = complex(self.spline(s, 1))
        return slope / abs(slope)

    def length(self, s: float) -> float:
        return float(np.trapz(np.abs(self.spline(np.linspace(0, s, 400), 1)), dx=s / 399)) if s > 0 else 0.0

    def drawn(self, count: int = 60, begin: float = 0, end: float = 1) -> list[complex]:
        return [self.at(s) for s in np.linspace(begin * self.chords, end * self.chords, count)]

    def side(self, away: float, begin: float, end: float, count: int = 40) -> list[complex]:
        """The curve at a distance to its left."""
        return [self.at(s) + away * 1j * self.tangent(s) for s in np.linspace(begin, end, count)]


def slot(panel: Panel, curve: Curve, begin: float, end: float, half: float) -> None:
    panel.area([*curve.side(half, begin, end), *round_end(curve, end, half, 1),
                *reversed(curve.side(-half, begin, end)), *round_end(curve, begin, half, -1)], "q")


def round_end(curve: Curve, s: float, half: float, way: int) -> list[complex]:
    t = way * curve.tangent(s)
    return [curve.at(s) + half * t * turned(angle) for angle in range(60, -61, -30)]


def circular_slot() -> Drawing:
    drawing = Drawing("Circular slot: center, radius, from, to", 284)
    panel = drawing.panel(70 + 186j)
    radius, begin, end, at = 150.0, -22.0, 62.0, 30.0
    panel.area([*(16 * turned(a) for a in range(82, 320, 20)),
                *((radius + 24) * turned(a) for a in range(-32, 73, 8))])
    arc = Curve([radius * turned(a) for a in range(-22, 63, 6)])
    slot(panel, arc, 0, arc.chords, 9)
    panel.line(0, (radius + 60) * turned(0), style="c")
    panel.line(0, (radius + 16) * turned(begin), style="x")
    panel.line(0, (radius + 16) * turned(end), style="x")
    panel.turn(0, 112, 0, begin, "d")
    panel.turn(0, 128, 0, end, "d")
    panel.text(112 * turned(begin * 0.6), "`from`", "", "end", right=-4)
    panel.text(128 * turned(48), "`to`", "", "end", right=-6, down=4)
    panel.line(0, radius * turned(at), style="d")
    panel.text(0.56 * radius * turned(at), "`radius`", right=-6, down=-2)
    panel.turn(0, 56, 0, at)
    panel.text(58 * turned(12), "angle", "", "start", right=2, down=4)
    panel.arrow(radius * turned(at), (radius + 44) * turned(at))
    panel.text((radius + 50) * turned(at), "force NAME", anchor="start", down=8)
    panel.pin(radius * turned(at), 8)
    panel.leader(radius * turned(at) + 6j, 168 + 138j, '`pin` = "b.P"')
    panel.pin(0)
    panel.leader(-2 - 3j, -8 - 52j, '`center` = "a.C"', "middle")
    panel.text(222 + 0j, "x axis of the body a", anchor="start", down=4)
    panel.texts(196 - 46j, ["angle of the body NAME,", "which turns with the pin"])
    return drawing


def curved_slot() -> Drawing:
    drawing = Drawing("Curved slot: curve, travel, from and to, forces", 372)
    panel = drawing.panel(62 + 204j)
    points = [40 + 14j, 96 + 54j, 150 + 104j, 214 + 122j, 276 + 100j, 318 + 56j]
    curve = Curve(points)
    begin, end, at = 26.0, curve.chords, 0.55 * curve.chords
    panel.area([-22 - 22j, 340 - 22j, 356 + 70j, 280 + 140j, 200 + 158j, 120 + 136j, -22 + 40j])
    slot(panel, curve, begin, end, 9)
    for k, way in ((0, -1), (-1, 1)):
        s = (0, curve.chords)[k]
        panel.line(curve.at(s), curve.at(s) + way * 34 * curve.tangent(s), style="c")
    panel.line(*curve.drawn(), style="c")
    panel.line(*points, style="d")
    for p in points:
        panel.dot(p, 2.6)
    panel.frame(0, size=34)
    panel.pin(0)
    panel.leader(-2 - 3j, 26 - 40j, '`at` = "a.O"', "middle")
    pin = curve.at(at)
    panel.pin(pin, 8)
    panel.leader(pin - 2 - 8j, pin - 10 - 44j, '`pin` = "b.P"', "middle")
    normal = 1j * curve.tangent(at)
    panel.arrow(pin, pin + 62 * normal)
    force = 62 * normal
    panel.arrow(pin, pin + force.real, "f", size=6)
    panel.arrow(pin + force.real, pin + force, "f", size=6)
    panel.text(pin + force, "force of the slot: NAME x, NAME y", right=-10, down=-6)
    panel.leader(curve.at(begin) + 8j * curve.tangent(begin), 20 + 92j, "`from`", "middle")
    panel.leader(curve.at(end) + 9 * curve.tangent(end), 300 + 14j, "`to`", "middle")
    panel.leader(points[1] + 0j, 120 + 22j, "`curve` = [[x, y], ...]", "start")
    ring = drawing.panel(368 + 318j)
    loop = Curve([38 * turned(a) * (1 + 0.3 * math.cos(math.radians(2 * a))) for a in range(0, 360, 45)], True)
    ring.line(*loop.drawn(48, 0, 1), style="w", closed=True)
    for p in loop.points:
        ring.dot(p, 2.6)
    panel.texts(-50 - 76j, ["travel s: along the chords (blue) to the pin",
                            "the slot ends at `from` and `to`; beyond the",
                            "ends the curve goes on straight (dashed)", "`closed` = true: as on the right"])
    return drawing


def rolling() -> Drawing:
    drawing = Drawing("Wheel on a line: radius, axis, offset", 278)
    panel = drawing.panel(46 + 168j)
    r, offset, angle = 56.0, 92.0, -100.0
    travel = offset - r * math.radians(angle)
    panel.ground(-24, 384)
    panel.circle(complex(offset, r), r, "c")
    panel.line(complex(offset, r), complex(offset + r, r), style="c")
    panel.circle(complex(travel, r), r, "a")
    center = complex(travel, r)
    panel.line(center, center + 0.82 * r * turned(angle))
    panel.dot(center + 0.82 * r * turned(angle))
    panel.line(center, center + r, style="c")
    panel.turn(center, 24, 0, angle)
    panel.leader(center + 25 * turned(-40), center + r + 14 - 26j, "angle < 0")
    panel.line(center, center + r * turned(125), style="d")
    panel.text(center + 0.5 * r * turned(125), "`radius`")
    panel.pin(center)
    panel.leader(center + 2 + 3j, center + 44 + 84j, '`wheel` = "b.C"')
    panel.arrow(travel - 46j, complex(travel))
    panel.text(travel - 46j, "normal force NAME", anchor="start", right=6, down=-2)
    panel.dot(0)
    panel.arrow(0, 40, "g", "m", 7)
    panel.text(0, '`line` = "a.A"', down=-24, right=-2)
    panel.line(4j, 20j, style="g")
    panel.text(40, "`axis`", right=-16, down=-6)
    panel.line(complex(offset, r), complex(offset, -30), style="x")
    panel.dimension(-18j, offset - 18j, "`offset`", one=True)
    panel.dimension(-64j, travel - 64j, "travel of the centre", one=True)
    panel.line(-4j, -68j, style="x")
    panel.line(travel - 46j, travel - 68j, style="x")
    panel.text(offset + 66j + 60j, "angle 0", "n")
    panel.text(-34 - 92j, "travel + `radius` · angle = `offset`", anchor="start")
    return drawing


def rolling_on_circle() -> Drawing:
    drawing = Drawing("Wheel on a circle: circle_radius, radius, inside", 292)
    big, small, a = 74.0, 30.0, 52.0
    for x, is_inside in ((104, False), (326, True)):
        panel = drawing.panel(x + 156j)
        center = (big - small if is_inside else big + small) * turned(a)
        panel.circle(0, big + 12 if is_inside else big, "e")
        if is_inside:
            panel.circle(0, big, "q")
        panel.circle(center, small, "a")
        panel.line(0, big + 22, style="c")
        panel.line(0, center + (small + 20) * turned(a), style="c")
        panel.turn(0, 26, 0, a)
        panel.text(28 * turned(20), "a", anchor="start", right=2, down=2)
        mark = 130.0 if is_inside else -10.0
        panel.line(center, center + 0.8 * small * turned(mark))
        panel.dot(center + 0.8 * small * turned(mark))
        panel.line(0, big * turned(205), style="d")
        panel.text(2 - 40j, "`circle_radius`")
        panel.line(center, center + small * turned(100), style="d")
        panel.pin(center)
        panel.pin(0)
    panel.text(0, "`inside` = true", down=-102)
    panel = drawing.panel(104 + 156j)
    center = (big + small) * turned(a)
    panel.leader(center + 0.7 * small * turned(100), center - 56 + 32j, "`radius`", "middle")
    panel.leader(center + 4j, center + 12 + 46j, '`wheel` = "b.C"', "middle")
    panel.leader(-2 + 3j, -48 + 84j, '`center` = "a.C"', "middle")
    panel.texts(-94 - 106j, ["`radius` (angle(wheel) - a) - `circle_radius` (a - angle(circle))",
                             "  = `offset`;  with `inside` + for the second -"])
    return drawing


def placed(curve: Curve, s: float, contact: complex, direction: complex) -> tuple[complex, complex]:
    """Turn and place of the body whose curve touches there with its tangent in a direction."""
    turn = direction / curve.tangent(s)
    return turn, contact - turn * curve.at(s)


def egg() -> Curve:
    steps = [math.radians(45 * k - 90) for k in range(8)]
    return Curve([complex(46 * math.cos(u), (32 + 7 * math.cos(u)) * math.sin(u)) for u in steps], True)


def runner() -> Curve:
    points = [-70 + 20j, -50 + 0j, -26 - 12j, 0 - 16j, 26 - 12j, 50 + 0j, 70 + 20j]
    return Curve(points, ends="not-a-knot")


def show_body(panel: Panel, curve: Curve, turn: complex, origin: complex, style: str, lid: Sequence[complex] = (),
              points: bool = True) -> None:
    panel.area([origin + turn * p for p in [*curve.drawn(41), *lid]], style)
    if points:
        for p in curve.points:
            panel.dot(origin + turn * p, 2.6)


def rolling_profile() -> Drawing:
    drawing = Drawing("Profile on a line: at, curve, offset, from, to", 408)
    panel = drawing.panel(40 + 128j)
    curve, offset = egg(), 96.0
    panel.ground(-24, 390)
    show_body(panel, curve, *placed(curve, 0, complex(offset), 1), "c", points=False)
    s = 0.58 * curve.chords
    contact = offset + curve.length(s)
    turn, origin = placed(curve, s, complex(contact), 1)
    show_body(panel, curve, turn, origin, "a")
    panel.frame(origin, math.degrees(cmath.phase(turn)), 22)
    panel.pin(origin)
    panel.leader(origin + 3j, origin + 54 + 60j, '`at` = "b.P"')
    panel.leader(origin + turn * curve.points[0], origin - 64 + 44j, "first point", "middle")
    panel.leader(origin + turn * curve.points[7], origin + 72 + 4j, "`curve`")
    panel.dot(offset, 2.6)
    panel.dot(contact, 4)
    panel.dimension(-16j, offset - 16j, "", one=True)
    panel.dimension(offset - 16j, contact - 16j, "", one=True)
    panel.text(offset / 2 - 32j, "`offset`")
    panel.text((offset + contact) / 2 - 32j, "arc of the curve")
    for x in (0, offset, contact):
        panel.line(x, x - 20j, style="x")
    panel.text(300 - 32j, "`closed` = true", anchor="start")
    panel.dot(0)
    panel.arrow(0, 40, "g", "m", 7)
    panel.leader(3j, 4 + 40j, '`line` = "a.A"', "middle")
    panel.text(40, "`axis`", right=-2, down=-7)
    panel = drawing.panel(208 + 318j)
    curve = runner()
    panel.ground(-190, 222)
    s = 0.62 * curve.chords
    turn, origin = placed(curve, s, 0, 1)
    show_body(panel, curve, turn, origin, "a", [60 + 44j, -60 + 44j])
    panel.pin(origin)
    panel.frame(origin, math.degrees(cmath.phase(turn)), 22)
    panel.dot(0, 4)
    for part, key, aside in ((0.12, "`from`", -46 + 6j), (0.9, "`to`", 42 + 16j)):
        tangent = turn * curve.tangent(part * curve.chords)
        there = origin + turn * curve.at(part * curve.chords)
        panel.line(there - 8j * tangent, there + 8j * tangent, style="d")
        panel.leader(there - 8j * tangent, there + aside - 10j * tangent, key, "end" if aside.real < 0 else "start")
    track = [origin + turn * (curve.at(u) - 7j * curve.tangent(u)) for u in np.linspace(0, s, 30)]
    panel.line(*track, style="w")
    panel.leader(track[11], track[11] - 92 - 4j, "travel s", "end")
    panel.leader(origin + turn * curve.points[0], origin + turn * curve.points[0] - 40 + 26j, "first point", "middle")
    panel.text(150 + 48j, "open, the body", "n")
    panel.text(150 + 48j, "on its left", "n", down=16)
    panel.arrow(-46j, 0)
    panel.text(-40j, "normal force NAME", anchor="start", right=8)
    panel.arrow(0, -44, "f")
    panel.text(-48 - 1j, "NAME friction", "", "end", down=22)
    panel.texts(-196 - 66j, ["s counts along the chords from the first point; `offset` is where",
                             "the contact is at s = 0"])
    return drawing


def rolling_profile_on_circle() -> Drawing:
    drawing = Drawing("Profile on a circle: circle_radius, inside, offset", 350)
    big = 84.0
    for x, is_inside in ((130, False), (328, True)):
        panel = drawing.panel(x + 184j)
        sense = -1 if is_inside else 1
        curve = Curve([0.6 * p for p in egg().points], True) if is_inside else runner()
        x_axis, offset, part = (222.0, 36.0, 0.2) if is_inside else (160.0, 24.0, 0.5)
        s = part * curve.chords
        first = x_axis - sense * math.degrees(offset / big)
        at = first - sense * math.degrees(curve.length(s) / big)
        panel.circle(0, big + 12 if is_inside else big, "e")
        if is_inside:
            panel.circle(0, big, "q")
        panel.line(0, (big + 24) * turned(x_axis), style="c")
        panel.text((big + 30) * turned(x_axis), "x axis", "n", down=8)
        panel.line(0, big * turned(at), style="d")
        turn, origin = placed(curve, s, big * turned(at), turned(at - 90 * sense))
        show_body(panel, curve, turn, origin, "a", [] if is_inside else [60 + 44j, -60 + 44j])
        panel.dot(big * turned(at), 4)
        away = big + (20 if is_inside else -10)
        panel.turn(0, away, x_axis, first, "d")
        panel.turn(0, away, first, at, "s")
        panel.line(big * turned(first), (away + 5 * (1 if is_inside else -1)) * turned(first), style="d")
        panel.pin(0)
        panel.turn(0, 22, x_axis, at, "d")
        where = away + (10 if is_inside else -8)
        panel.text(where * turned((x_axis + first) / 2), "`offset`", "", "end" if is_inside else "start",
                   right=-6 if is_inside else -2, down=10 if is_inside else 12)
        if is_inside:
            panel.line(0, big * turned(50), style="d")
        panel.text(big * 0.44 * turned(50 if is_inside else at), "`circle_radius`", right=2)
        if is_inside:
            panel.text(112j, "`inside` = true")
            panel.text((away + 6) * turned((first + at) / 2), "arc of the curve", anchor="start", right=-12, down=16)
        else:
            panel.leader(3 - 2j, 8 - 34j, '`center` = "a.C"', "middle")
            panel.leader(origin, origin + 68 + 58j, '`at` = "b.P"', "middle")
        panel.pin(origin, 3)
    panel.texts(-318 - 142j, ["inner arc: angle of \"NAME radius\" to the contact, from the x axis",
                              "of the body of `center`; behind `offset` the arc of the curve"])
    return drawing


def hollow_rocker() -> Drawing:
    drawing = Drawing("Hollow rocker: the second contact is not found", 170)
    panel = drawing.panel(220 + 92j)
    points = [-124 + 30j, -104 + 6j, -78 + 0j, -44 + 12j, 0 + 18j, 44 + 12j, 78 + 0j, 104 + 6j, 124 + 30j]
    curve = Curve(points, ends="not-a-knot")
    foot = min(np.linspace(0, 0.5 * curve.chords, 800), key=lambda s: curve.at(s).imag)
    turn, origin = placed(curve, foot, complex(curve.at(foot).real), 1)
    panel.ground(-190, 190)
    show_body(panel, curve, turn, origin, "a", [110 + 62j, -110 + 62j])
    left, right = complex(curve.at(foot).real), complex(-curve.at(foot).real)
    panel.dot(left, 4.5)
    panel.circle(right, 5, "f")
    panel.arrow(left - 44j, left)
    panel.text(left - 44j, "the contact, at s", anchor="end", right=-8)
    panel.text(right - 30j, "not found: not confirmed", down=4)
    panel.text(76j, "hollow: the curve cuts into the line as it tips", "n")
    return drawing
