"""Drawings of scene-files.md: frames, joints, measures, force elements, loads and functions of time."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from drawing import Drawing, Panel, turned


def plate(panel: Panel, a: complex, b: complex, style: str = "a") -> None:
    panel.link(a, b, 10, style)


def frames() -> Drawing:
    drawing = Drawing("Frames: the world, a body, its points and its angle", 280)
    panel = drawing.panel(52 + 214j)
    origin, angle = 118 + 46j, 32.0
    t = turned(angle)
    panel.frame(0, size=52)
    panel.support(0)
    panel.area([origin + t * p for p in (-24 - 20j, 130 - 26j, 200 + 4j, 196 + 32j, 120 + 46j, -24 + 24j)])
    panel.frame(origin, angle, 50)
    panel.line(origin, origin + 84, style="c")
    panel.turn(origin, 66, 0, angle)
    panel.leader(origin + 66 * turned(10), origin + 116 - 18j, "angle of the body")
    panel.pin(origin)
    point, center = origin + t * (160 + 10j), origin + t * (92 + 20j)
    panel.pin(point)
    panel.leader(point, point + 28 + 34j, '"arm.B"')
    panel.circle(center, 6, "q")
    panel.line(center - 6, center + 6)
    panel.line(center - 6j, center + 6j)
    panel.leader(center + 6j, center - 44 + 44j, "`center`", "middle")
    panel.leader(-3j, 30 - 34j, "ground: the world", "start")
    panel.leader(origin - 3j, origin + 46 - 46j, "its origin")
    panel.text(origin - 70 + 128j, "`[body.arm]`", "", "middle")
    panel.text(-38 - 44j, "`points` = { B = [160, 10] } and `center`: in the body's own frame", anchor="start", down=14)
    return drawing


def joints() -> Drawing:
    drawing = Drawing("Joints: pin, weld, bar, slide, pin in a slot", 400)
    panel = drawing.panel(70 + 106j)
    plate(panel, -44 - 26j, 0)
    plate(panel, 0, 44 - 10j, "e")
    panel.pin(0, 5)
    panel.text(52j, "`[[pin]]`")
    panel.text(-26 + 14j, "a.P = b.Q", "", "middle", right=16)
    panel = drawing.panel(214 + 106j)
    plate(panel, -54 + 0j, 0)
    plate(panel, 0, 44 * turned(50), "e")
    panel.block(0, 14, 14, 0, "q")
    panel.line(-7 - 7j, 7 + 7j)
    panel.line(-7 + 7j, 7 - 7j)
    panel.line(0, 52, style="c")
    panel.turn(0, 34, 0, 50, "d")
    panel.text(38 * turned(20), "`angle`", anchor="start", right=2, down=4)
    panel.text(-20 + 52j, "`[[weld]]`")
    panel = drawing.panel(352 + 106j)
    p, q = -40 - 24j, 36 + 18j
    panel.line(p, q, style="v")
    panel.pin(p)
    panel.pin(q)
    panel.dimension(p, q, "`length`", -20)
    panel.text(p, "a.P", right=-14, down=-6)
    panel.text(q, "b.Q", right=14, down=-6)
    panel.text(52j, "`[[bar]]`")
    for x, is_slide in ((22, True), (240, False)):
        panel = drawing.panel(x + 282j)
        t = turned(14)
        start, travel = 14 + 6j, 96.0
        end = start + travel * t
        panel.line(start - 20 * t, start + 160 * t, style="c")
        panel.pin(start)
        panel.arrow(start, start + 36 * t, "g", "m", 7)
        panel.text(start + 30 * t, "`axis`", down=-10, right=-12)
        if is_slide:
            for side in (11j, -11j):
                panel.line(start + (50 + side) * t, start + (150 + side) * t)
            panel.block(end, 40, 18, 14, "e")
            plate(panel, end, end + 50 * t * turned(46), "e")
            panel.turn(end, 40, 14, 60, "d")
            panel.text(end + 44 * turned(38), "`angle`", anchor="start", right=4)
        else:
            panel.area([start + p * t for p in (40 + 8j, 150 + 8j, 150 - 8j, 40 - 8j)], "q")
            plate(panel, end, end + 46 * turned(80), "e")
        panel.pin(end, 5)
        panel.dimension(start, end, "travel", -38, one=True)
        panel.text(start, "a.P", right=-4, down=22)
        panel.text(end, "b.Q", right=24, down=27)
        panel.text(82 + 112j, "`[[slide]]`" if is_slide else "`[[pin_in_slot]]`")
    drawing.panel(14 + 366j).texts(0, ['`points` = ["a.P", "b.Q"];  the `axis` is fixed in body a',
                                       "`angle` = angle(b) - angle(a);  in a slot b turns freely"])
    return drawing


def measures() -> Drawing:
    drawing = Drawing("Measures: distance, component, angle, coordinates", 352)

    def pair(panel: Panel) -> tuple[complex, complex]:
        a, b = 24 + 16j, 138 + 66j
        panel.pin(a)
        panel.pin(b)
        panel.text(a, "a.P", right=-8, down=20)
        panel.text(b, "b.Q", right=16, down=-8)
        return a, b

    panel = drawing.panel(20 + 116j)
    a, b = pair(panel)
    panel.dimension(a, b, "g", 0)
    panel.text(80 + 98j, '`points` = ["a.P", "b.Q"]')
    panel = drawing.panel(236 + 116j)
    a, b = pair(panel)
    t = turned(-4)
    foot = a + t * ((b - a) / t).real
    panel.line(a - 10 * t, a + 150 * t, style="c")
    panel.line(b, foot - 14j * t, style="x")
    panel.dimension(a - 10j * t, foot - 10j * t, "g", one=True)
    panel.arrow(a, a + 40 * t, "g", "m", 7)
    panel.text(a + 44 * t, "`axis`", right=-2, down=-9)
    panel.text(88 + 98j, '`points` and `axis` = [x, y]')
    panel = drawing.panel(52 + 262j)
    plate(panel, -20, 80 * turned(8))
    plate(panel, 0, 74 * turned(66), "e")
    panel.turn(0, 50, 8, 66)
    panel.text(56 * turned(36), "g", anchor="start", down=4)
    panel.text(90 * turned(6), "a", anchor="start", right=4)
    panel.text(86 * turned(70), "b", right=10)
    panel.pin(0, 5)
    panel.text(50 + 100j, '`bodies` = ["a", "b"]')
    panel = drawing.panel(264 + 270j)
    panel.frame(0, size=40)
    p = 106 + 66j
    panel.line(p, 106, style="x")
    panel.line(p, 66j, style="x")
    panel.dimension(-14j, 106 - 14j, "`x`", one=True)
    panel.dimension(-16, -16 + 66j, "`y`", one=True)
    panel.pin(p)
    panel.text(p, "b.P", right=18, down=-4)
    panel.text(60 + 108j, '`x` = "b.P" or `y` = "b.P"')
    drawing.panel(14 + 322j).texts(0, ['`slide` = "NAME": its travel;  `rope`: its length over pulleys',
                                       "`sum`: factors times such measures"])
    return drawing


def chart(drawing: Drawing, origin: complex, width: float, height: float, x: str, y: str, low: float = 0) -> Panel:
    panel = drawing.panel(origin)
    panel.arrow(complex(-4), complex(width), "g", "m", 6)
    panel.arrow(complex(0, -low - 4), complex(0, height), "g", "m", 6)
    panel.text(complex(width), x, "n", "end", down=-6)
    panel.text(complex(0, height), y, "n", "start", right=6, down=4)
    return panel


def graph(panel: Panel, law: Callable[[float], float], begin: float, end: float, count: int = 40) -> None:
    panel.line(*(complex(x, law(x)) for x in np.linspace(begin, end, count)), style="w")


def slope(panel: Panel, at: complex, dx: float, dy: float, text: str) -> None:
    panel.line(at, at + dx, at + complex(dx, dy), style="d")
    panel.text(at + complex(dx, dy / 2), text, anchor="start", right=4, down=4)


def springs() -> Drawing:
    drawing = Drawing("Springs: stiffness, free_length, preload, acts, cubic", 416)
    panel = drawing.panel(30 + 58j)
    panel.ground(18j, -18j)
    panel.spring(0, 150)
    panel.pin(0)
    panel.pin(150)
    panel.dimension(0, 150, "g", -24)
    panel.arrow(196, 158)
    panel.texts(204 + 8j, ["T > 0 pulls both ends", "towards each other"])
    panel = chart(drawing, 36 + 190j, 168, 84, "g", "T", 24)
    graph(panel, lambda g: 0.62 * (g - 56), 20, 160, 2)
    panel.dot(56)
    panel.leader(56, 62 - 26j, "`free_length`", "start")
    slope(panel, 92 + 22.3j, 34, 21, "`stiffness`")
    panel = chart(drawing, 256 + 190j, 168, 84, "g", "T", 24)
    graph(panel, lambda g: 36 + 0.5 * (g - 70), 10, 150, 2)
    panel.line(70, 70 + 36j, 36j, style="x")
    panel.dot(70 + 36j)
    panel.text(70, "`length`", down=16)
    panel.text(36j, "`preload`", anchor="start", right=4, down=-6)
    panel = chart(drawing, 36 + 312j, 168, 78, "g", "T", 24)
    panel.line(8, 66, 144 + 62j, style="w")
    panel.line(16 - 40j + 0j, 66, style="c")
    panel.text(40 + 50j, '`acts` = "tension"', anchor="start", right=-24, down=-10)
    panel = chart(drawing, 256 + 312j, 168, 78, "g", "T", 24)
    graph(panel, lambda g: 0.3 * (g - 70) + 0.00012 * (g - 70) ** 3, 6, 140)
    panel.line(12 - 17.4j, 150 + 24j, style="c")
    panel.dot(70)
    panel.leader(122 + 31j, 84 + 58j, "`cubic` > 0", "end")
    panel.text(70, "`free_length`", down=20, right=30)
    drawing.panel(14 + 376j).texts(0, ['`acts` = "compression": the dashed half; "both": all of it',
                                       "on an angle: `free_angle`, `angle` and `torque`, of body b"])
    return drawing


def spring_curve() -> Drawing:
    drawing = Drawing("Spring of a curve: curve, scale, shift", 232)
    panel = chart(drawing, 50 + 164j, 360, 136, "g", "force")
    x = np.array([40, 90, 140, 190, 250, 300], float)
    f = np.array([10, 22, 60, 68, 68, 104], float)

    def monotone(g: float) -> float:
        secant = np.diff(f) / np.diff(x)
        h = np.diff(x)
        m = [float(secant[0])]
        for k in range(len(secant) - 1):
            left, right = float(secant[k]), float(secant[k + 1])
            w = (h[k] + 2 * h[k + 1]) / (3 * (h[k] + h[k + 1]))
            m.append(0.0 if left * right <= 0 else left * right / (w * right + (1 - w) * left))
        m.append(float(secant[-1]))
        if g <= x[0]:
            return float(f[0] + m[0] * (g - x[0]))
        if g >= x[-1]:
            return float(f[-1] + m[-1] * (g - x[-1]))
        k = int(np.searchsorted(x, g, side="right")) - 1
        s = (g - x[k]) / h[k]
        return float(f[k] * (1 + 2 * s) * (1 - s) ** 2 + m[k] * h[k] * s * (1 - s) ** 2
                     + f[k + 1] * s * s * (3 - 2 * s) + m[k + 1] * h[k] * s * s * (s - 1))

    graph(panel, monotone, 40, 300, 90)
    panel.line(complex(14, monotone(14)), complex(40, monotone(40)), style="c")
    panel.line(complex(300, monotone(300)), complex(322, monotone(322)), style="c")
    for a, b in zip(x, f):
        panel.dot(complex(a, b), 3.4)
    panel.leader(140 + 60j, 96 + 104j, "`curve` = [[x, F], ...]", "middle")
    panel.leader(220 + 68j, 252 + 34j, "level: no ripple", "middle")
    panel.leader(312 + monotone(312) * 1j, 268 + 128j, "on along the tangent", "end")
    panel.texts(-36 - 34j, ["force = `scale` · F(g - `shift`): F is steeper by `scale`, and moves",
                            "to the right by `shift`"])
    return drawing


def gas_strut() -> Drawing:
    drawing = Drawing("Gas strut: preload, length, stroke, ratio, friction", 368)
    panel = drawing.panel(30 + 56j)
    panel.block(90, 150, 30)
    panel.block(196, 86, 9, style="q")
    panel.block(152, 8, 26, style="q")
    panel.pin(8)
    panel.pin(246)
    panel.dimension(8, 246, "`length`", -30)
    panel.arrow(254, 300)
    panel.text(304, "`preload`", anchor="start", down=4)
    panel = drawing.panel(30 + 136j)
    panel.block(90, 150, 30)
    panel.block(148, 62, 9, style="q")
    panel.block(58, 8, 26, style="q")
    panel.block(120, 116, 9, style="q")
    panel.pin(8)
    panel.pin(184)
    panel.line(184, 184 - 36j, style="x")
    panel.line(246 + 14j, 246 - 36j, style="x")
    panel.dimension(184 - 26j, 246 - 26j, "", 0)
    panel.text(254 - 26j, "`stroke`", anchor="start", down=4)
    panel.arrow(192, 272)
    panel.text(276, "`ratio` · `preload`", anchor="start", down=4)
    panel = chart(drawing, 74 + 316j, 300, 118, "g", "push")
    ratio, exponent = 1.5, 1.4
    taken = 1 - math.pow(ratio, -1 / exponent)

    def push(g: float) -> float:
        return 60 * math.pow(1 - taken * (220 - g) / 160, -exponent)

    graph(panel, push, 60, 220)
    for away in (7, -7):
        panel.line(*(complex(g, push(g) + away) for g in np.linspace(60, 220, 20)), style="c")
    panel.line(220, 220 + 60j, 60j, style="x")
    panel.line(60, 60 + 90j, 90j, style="x")
    panel.text(60j, "`preload`", "", "end", right=-4, down=6)
    panel.text(90j, "`ratio`", "", "end", right=-4, down=-6)
    panel.text(90j, "times it", "", "end", right=-4, down=8)
    panel.text(220, "`length`", anchor="start", right=4, down=16)
    panel.dimension(60 - 12j, 220 - 12j, "`stroke`", 0)
    panel.leader(140 + push(140) * 1j, 176 + 108j, "`exponent` n of p V^n", "start")
    panel.leader(200 + (push(200) - 7) * 1j, 244 + 38j, "± `friction`", "start")
    panel.texts(-60 - 40j, ["a stop of its name holds g from `length` - `stroke` to `length`"])
    return drawing


def bump_stop() -> Drawing:
    drawing = Drawing("Bump stop: free_length, depth, force, exponent", 218)
    panel = chart(drawing, 40 + 160j, 360, 128, "g", "push")
    free, depth, force = 230.0, 130.0, 76.0
    graph(panel, lambda g: force * max(0.0, (free - g) / depth) ** 2, 76, 360, 60)
    panel.line(*(complex(g, force * (free - g) / depth) for g in (100, free)), style="c")
    panel.line(free - depth, free - depth + force * 1j, complex(0, force), style="x")
    panel.line(free - depth, free - depth - 20j, style="x")
    panel.line(free, free - 20j, style="x")
    panel.dot(free)
    panel.dot(complex(free - depth, force))
    panel.text(complex(0, force), "`force`", anchor="start", right=4, down=-6)
    panel.dimension(free - 14j, free - depth - 14j, "`depth`", 0)
    panel.text(free, "`free_length`", anchor="start", right=6, down=18)
    panel.leader(166 + 18.4j, 196 + 70j, "`exponent` = 2: soft at first", "start")
    panel.leader(188 + 24.5j, 236 + 48j, "`exponent` = 1", "start")
    panel.text(-26 - 46j, '`acts` = "compression": pushes while g < `free_length`', anchor="start")
    return drawing


def loads() -> Drawing:
    drawing = Drawing("Loads: at, vector, direction, size, follows, torque", 316)
    panel = drawing.panel(40 + 132j)
    t = turned(24)
    plate(panel, 0, 120 * t)
    panel.support(0)
    panel.pin(120 * t)
    panel.arrow(120 * t + 54j, 120 * t + 5j)
    panel.text(120 * t + 58j, "`vector` = [0, -40]", right=-6, down=-2)
    panel.leader(120 * t + 3, 120 * t + 34 - 22j, '`at` = "arm.B"')
    panel = drawing.panel(262 + 132j)
    for angle, style in ((2, "q"), (34, "a")):
        panel.link(0, 110 * turned(angle), 8, style)
        p = 110 * turned(angle)
        panel.arrow(p + 46 * 1j * turned(angle), p + 8j * turned(angle))
    panel.support(0)
    panel.text(50 + 112j, '`follows` = "arm": it turns too')
    panel = drawing.panel(40 + 254j)
    plate(panel, 0, 150)
    for k in range(7):
        panel.arrow(complex(k * 25, 40), complex(k * 25, 11), size=6)
    panel.line(40j, 150 + 40j, style="f")
    panel.pin(0)
    panel.pin(150)
    panel.text(75 + 52j, "`[[distributed_load]]`, F/L")
    panel.text(75 - 30j, '`points` = ["b.P", "b.Q"]')
    panel = drawing.panel(320 + 254j)
    plate(panel, -50, 50)
    panel.pin(0)
    panel.turn(0, 30, -30, 200, "f")
    panel.text(52j, "`[[torque]]`: `value` > 0")
    panel.text(-30j, '`on` = "b", or `at` a point')
    drawing.panel(14 + 306j).text(0, "`direction` and `size`: `vector` = size · unit direction", anchor="start")
    return drawing


def time_functions() -> Drawing:
    drawing = Drawing("Functions of time: sine, ramp, step, table", 336)
    panel = chart(drawing, 34 + 124j, 176, 96, "t", "c(t)")
    graph(panel, lambda t: 40 + 28 * math.sin(2 * math.pi * t / 92 + 0.6), 0, 166, 70)
    panel.line(40j, 166 + 40j, style="c")
    panel.dimension(150, 150 + 40j, "`offset`", aside=30)
    top = 92 * (0.25 - 0.6 / (2 * math.pi))
    panel.dimension(top + 40j, top + 68j, "", 0)
    panel.text(top + 54j, "`amplitude`", anchor="start", right=5, down=2)
    panel.dimension(top + 80j, top + 92 + 80j, "", 0)
    panel.text(top + 46 + 90j, "1/`frequency`", right=14)
    panel.text(0, "`phase`: where it begins", anchor="start", right=2, down=16)
    panel.text(84 + 106j, "`sine`")
    panel = chart(drawing, 256 + 124j, 176, 96, "t", "c(t)")

    def ramp(t: float) -> float:
        s = min(1.0, max(0.0, (t - 44) / 76))
        return 20 + 54 * s ** 3 * (10 - 15 * s + 6 * s * s)

    graph(panel, ramp, 0, 168, 60)
    panel.line(44 + 20j, 120 + 74j, style="c")
    panel.line(44 + 20j, 44, style="x")
    panel.line(120 + 74j, 120, style="x")
    panel.line(74j, 120 + 74j, style="x")
    panel.text(20j, "`from`", anchor="start", right=4, down=-6)
    panel.text(74j, "`to`", anchor="start", right=4, down=14)
    panel.text(44, "`start`", down=15)
    panel.text(120, "`end`", down=15)
    panel.leader(70 + ramp(70) * 1j, 98 + 24j, "`law`", "start")
    panel.text(84 + 106j, "`ramp`")
    panel = chart(drawing, 34 + 262j, 176, 86, "t", "c(t)")
    panel.line(16j, 70 + 16j, style="w")
    panel.line(70 + 60j, 166 + 60j, style="w")
    panel.line(70, 70 + 60j, style="c")
    panel.text(70, "`at`", down=15)
    panel.text(16j, "`from`", anchor="start", right=4, down=-6)
    panel.text(110 + 60j, "`to`", down=-6)
    panel.text(84 + 94j, "`step`")
    panel = chart(drawing, 256 + 262j, 176, 86, "t", "c(t)")
    points = [24 + 14j, 60 + 60j, 100 + 40j, 140 + 40j]
    panel.line(14j, *points, 168 + 40j, style="w")
    for p in points:
        panel.dot(p)
    panel.leader(100 + 40j, 96 + 76j, "[t, c]", "start")
    panel.text(84 + 94j, "`table`")
    drawing.panel(14 + 306j).texts(0, ["`law` of a ramp: `linear` (dashed), `polynomial_345`",
                                       "`interpolation` of a table: `linear`, `monotone`, `spline`"])
    return drawing


def time_ways() -> Drawing:
    drawing = Drawing("Laws from one value to another: rate and acceleration", 336)

    def s_curve_rate(s: float) -> float:
        s = min(s, 1 - s)
        if s >= 1 / 3:
            return 1.5
        u = 3 * s
        return 3 * u * u if u < 0.5 else 1.5 - 3 * (1 - u) ** 2

    def s_curve_pull(s: float) -> float:
        u = 3 * min(s, 1 - s)
        size = 0 if u >= 1 else 18 * u if u < 0.5 else 18 * (1 - u)
        return size if s < 0.5 else -size

    rates = {
        "cubic": (lambda s: 6 * s * (1 - s), lambda s: 6 - 12 * s),
        "trapezoidal": (lambda s: min(1.5, 4.5 * s, 4.5 * (1 - s)),
                        lambda s: 4.5 if s < 1 / 3 else -4.5 if s > 2 / 3 else 0),
        "s_curve": (s_curve_rate, s_curve_pull),
        "polynomial_345": (lambda s: 30 * (s * (1 - s)) ** 2, lambda s: 60 * s * (1 - s) * (1 - 2 * s)),
    }
    width = 160
    for k, (name, (rate, pull)) in enumerate(rates.items()):
        panel = chart(drawing, 34 + 222 * (k % 2) + (124 + 142 * (k // 2)) * 1j, width + 10, 96, "t", "")
        graph(panel, lambda t, r=rate: 36 + 30 * r(t / width), 0, width, 36)
        points = [s * width + (36 + 3.8 * pull(s)) * 1j for s in (i / 48 for i in range(49))]
        panel.line(*points, style="c")
        panel.line(36j, width + 36j, style="x")
        panel.text(width / 2 + 106j, f"`{name}`")
    drawing.panel(14 + 306j).texts(0, ["rate (solid) and acceleration (dashed) between two values:",
                                       "`law` of a ramp, `interpolation` of a table"])
    return drawing


def section() -> Drawing:
    drawing = Drawing("Section: line, height, left, profile", 236)
    panel = drawing.panel(28 + 132j)
    bend = [0j, 130 + 0j, 200 + 62j]
    panel.line(-9j, 134 - 9j, 207 + 54j, 193 + 70j, 126 + 9j, 9j, closed=True, style="a")
    panel.line(*bend, style="c")
    for p, name, down in zip(bend, ("A", "K", "T"), (-16, -16, -16)):
        panel.pin(p)
        panel.text(p, name, down=down, right=-6)
    panel.text(96 - 36j, '`line` = ["A", "K", "T"]')
    panel.arrow(30 + 24j, 70 + 24j, "s")
    panel.text(50 + 32j, "left of it: up")
    panel = drawing.panel(320 + 112j)
    h, b, w, f = 56.0, 40.0, 4.0, 6.0
    half = [complex(b, h), complex(b, h - f), complex(w, h - f), complex(w, -h + f), complex(b, -h + f), complex(b, -h)]
    panel.area([*half, *(complex(-p.real, p.imag) for p in reversed(half))], "e")
    at = 8.0
    panel.line(complex(-66, at), complex(66, at), style="c")
    panel.dot(complex(0, at))
    panel.dimension(complex(58, -h), complex(58, h), "`height`", 0)
    panel.line(complex(b, h), complex(64, h), style="x")
    panel.line(complex(b, -h), complex(64, -h), style="x")
    panel.line(complex(-b, h), complex(-64, h), style="x")
    panel.dimension(complex(-56, at), complex(-56, h), "`left`", 0)
    panel.text(74j, "`profile`, `area`")
    panel.text(-74j, "`second_moment`")
    drawing.panel(14 + 218j).text(0, "`left`: from the line to the extreme fibre on its left", anchor="start")
    return drawing
