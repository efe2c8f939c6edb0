"""Drawings of experiment-files.md and design-files.md, and of stops and drives."""

from __future__ import annotations

import math

import numpy as np
from basics import chart, graph
from drawing import Drawing, turned


def stop_drive() -> Drawing:
    drawing = Drawing("Stops and drives: min, max, start, rate, amplitude", 350)
    panel = drawing.panel(40 + 86j)
    panel.ground(-16 - 16j, 260 - 16j)
    panel.line(0, 270, style="c")
    panel.block(120, 44, 28)
    panel.pin(120, 5)
    for x in (40, 214):
        panel.block(complex(x + (-26 if x < 100 else 26)), 8, 30, style="e")
    panel.dot(0)
    panel.dimension(24j, 120 + 24j, "g", one=True)
    panel.dimension(44j, 40 + 44j, "`min`", one=True)
    panel.dimension(62j, 214 + 62j, "`max`", one=True)
    for x, y in ((0, 66), (40, 48), (120, 28), (214, 66)):
        panel.line(complex(x), complex(x, y), style="x")
    panel.texts(284 + 32j, ["`[[stop]]`: g", "stays from", "`min` to `max`"])
    panel = chart(drawing, 40 + 282j, 372, 128, "t", "g(t)")

    def driven(t: float) -> float:
        return 30 + 0.16 * t + 20 * (math.sin(2 * math.pi * t / 110 + 0.5) - math.sin(0.5))

    graph(panel, driven, 0, 330, 90)
    mean = [complex(t, 30 + 0.16 * t - 20 * math.sin(0.5)) for t in (0, 330)]
    panel.line(*mean, style="c")
    panel.leader(30j, 18 + 96j, "`start`")
    panel.line(238 + mean[0].imag * 1j + 0.16j * 238, 298 + mean[0].imag * 1j + 0.16j * 238,
               298 + mean[0].imag * 1j + 0.16j * 298, style="d")
    panel.leader(298 + mean[0].imag * 1j + 0.16j * 292, 322 + 34j, "`rate`", "start")
    top = 110 * (0.25 - 0.5 / (2 * math.pi))
    for k in (1, 2):
        panel.line(complex(top + 110 * k, driven(top + 110 * k)), complex(top + 110 * k, 122), style="x")
    panel.dimension(complex(top + 110, 116), complex(top + 220, 116), "1/`frequency`")
    panel.dimension(complex(top + 110, 30 + 0.16 * (top + 110) - 20 * math.sin(0.5)), complex(top + 110,
                    driven(top + 110)), "")
    panel.leader(complex(top + 110, 54), complex(top + 136, 26), "`amplitude`")
    panel.text(4 + 8j, "`phase`: where it begins", anchor="start")
    panel.texts(-26 - 36j, ["`[[drive]]`: with `acceleration` the dashed line is a parabola"])
    return drawing


def sensor() -> Drawing:
    drawing = Drawing("Sensor: column, zero, factor, delay", 290)
    panel = chart(drawing, 40 + 226j, 372, 196, "t", "")

    def g(t: float) -> float:
        return 40 + 26 * math.cos(2 * math.pi * t / 150) * math.exp(-t / 420)

    delay, zero, factor = 34.0, -52.0, 0.75
    graph(panel, g, 0, 340, 80)
    times = np.arange(0, 341, 17)
    for t in times:
        panel.dot(complex(t, (g(t - delay) - zero) / factor), 2.4)
    panel.line(0, complex(0, -4))
    panel.text(220 + 6j, "quantity g of the mechanism", anchor="start", right=-74, down=-2)
    panel.text(180 + 176j, "`column` of the data file", anchor="start", right=0, down=-2)
    top = 150.0
    panel.line(complex(top, g(top)), complex(top, 170), style="x")
    panel.line(complex(top + delay, (g(top) - zero) / factor), complex(top + delay, 98), style="x")
    panel.dimension(complex(top, 104), complex(top + delay, 104), "", one=True)
    panel.text(complex(top + delay, 104), "`delay`", anchor="start", right=6, down=4)
    panel.texts(-26 - 38j, ["`column` = (g(t - `delay`) - `zero`) / `factor`,  scatter: `noise`"])
    return drawing


def run() -> Drawing:
    drawing = Drawing("Run: rest, release, duration, rate", 246)
    panel = chart(drawing, 40 + 186j, 380, 160, "t", "angle")

    def angle(t: float) -> float:
        return 70 + 56 * math.cos(2 * math.pi * t / 92) * math.exp(-t / 190)

    graph(panel, angle, 0, 320, 110)
    for t in np.arange(0, 321, 10):
        panel.dot(complex(t, angle(t)), 2)
    panel.line(70j, 340 + 70j, style="c")
    panel.text(340 + 70j, "`rest`: `at`", "", "end", right=34, down=-8)
    panel.dimension(6 + 70j, 6 + 126j, "", one=True)
    panel.text(10 + 100j, "`release`", anchor="start", right=2)
    panel.dimension(12j, 320 + 12j, "`duration`")
    panel.dimension(complex(220, 108), complex(230, 108), "", 0)
    panel.leader(225 + 112j, 236 + 138j, "1/`rate`", "start")
    panel.line(complex(220, angle(220)), 220 + 112j, style="x")
    panel.line(complex(230, angle(230)), 230 + 112j, style="x")
    panel.texts(-26 - 38j, ["`release_rate`: the slope at t = 0;  `sensors` read the dots"])
    return drawing


def goals() -> Drawing:
    drawing = Drawing("Goals: over, at, least, most, curve, within, aim", 334)
    panel = chart(drawing, 50 + 152j, 360, 128, "`along`", "`of`")

    def quantity(x: float) -> float:
        return 52 + 34 * math.sin((x - 40) / 44) * math.exp(-x / 500)

    panel.area([40 + 16j, 320 + 16j, 320 + 92j, 40 + 92j], "e")
    graph(panel, quantity, 40, 320, 60)
    for x in np.linspace(40, 320, 9):
        panel.dot(complex(x, quantity(x)), 2.6)
    panel.text(320 + 92j, "`most`", anchor="start", right=4, down=4)
    panel.text(320 + 16j, "`least`", anchor="start", right=4, down=-4)
    panel.dimension(40 - 12j, 320 - 12j, "`over` = [FROM, TO]")
    panel.leader(complex(250, quantity(250)), 226 + 112j, "`positions` of the search", "middle")
    panel = chart(drawing, 50 + 292j, 360, 104, "`along`", "`of`")

    def wanted(x: float) -> float:
        return 26 + 50 * math.pow((x - 40) / 280, 1.4)

    for away in (10, -10):
        panel.line(*(complex(x, wanted(x) + away) for x in np.linspace(40, 320, 30)), style="x")
    panel.line(*(complex(x, wanted(x)) for x in np.linspace(40, 320, 30)), style="c")
    graph(panel, lambda x: wanted(x) + 6 * math.sin(x / 34), 40, 320, 60)
    panel.leader(complex(120, wanted(120)), 84 + 82j, "`curve`", "middle")
    panel.dimension(complex(320, wanted(320)), complex(320, wanted(320) + 10), "")
    panel.text(complex(320, wanted(320) + 6), "`within`", anchor="start", right=6, down=4)
    panel.line(220, complex(220, wanted(220) + 6 * math.sin(220 / 34)), style="c")
    panel.dot(complex(220, wanted(220) + 6 * math.sin(220 / 34)), 4)
    panel.text(220, "`at`: `equals`", down=17)
    panel.text(-36 - 34j, "`aim` = \"curve\": as near as may be", anchor="start")
    return drawing


def straight_line() -> Drawing:
    drawing = Drawing("A straight line: travel, drift, transmission, lever", 356)
    panel = drawing.panel(88 + 246j)
    start, p = 150 + 24j, 96 * turned(58)
    top = p + 130 * turned(-8)
    for pivot in (0, start):
        panel.support(pivot)
    panel.line(0, 84, style="c")
    panel.link(0, p, 6)
    panel.link(p, top, 6, "q")
    panel.link(start, top, 6, "e")
    tip = top + 44 * turned(34)
    panel.link(top, tip, 6, "q")
    for x in (p, top, tip):
        panel.pin(x)
    panel.arc(0, 62, 22, 58, "d")
    panel.turn(0, 62, 22, 58, "d")
    panel.text(66 * turned(36), "`turn`", anchor="start", right=4)
    panel.turn(0, 40, 0, 22, "d")
    panel.text(44 * turned(8), "`from`", anchor="start", right=2, down=5)
    panel.turn(top, 34, 172, 222, "d")
    panel.leader(top + 34 * turned(176), top - 66 + 56j, "`transmission`", "middle")
    # The path of the point.
    way = [complex(tip.real + 5 * math.sin(s / 17), s) for s in np.linspace(20, 190, 60)]
    panel.line(*way, style="w")
    for x in (tip.real - 5, tip.real + 5):
        panel.line(complex(x, 14), complex(x, 196), style="x")
    panel.dimension(complex(tip.real + 34, 20), complex(tip.real + 34, 190), "`travel`")
    panel.line(complex(tip.real, 20), complex(tip.real + 38, 20), style="x")
    panel.line(complex(tip.real, 190), complex(tip.real + 38, 190), style="x")
    panel.leader(complex(tip.real + 5, 196), complex(tip.real - 26, 216), "`drift`: the width of the path", "middle")
    panel.text(tip, "`point`", "", "end", right=-12, down=-8)
    # The jack.
    foot, hold = -44 + 46j, 0.52 * p
    panel.line(foot, hold, style="v")
    panel.pin(foot)
    panel.pin(hold)
    panel.leader(0.5 * (foot + hold), -6 + 108j, "`points` of the jack", "middle")
    t = (hold - foot) / abs(hold - foot)
    near = foot - t * ((foot / t).real)
    panel.line(0, near, style="d")
    panel.leader(0.5 * near, -50 + 8j, "`lever`", "middle")
    panel.texts(-64 - 48j, ["`ratio`: of the jack's longest to its shortest length",
                            "`level`: a body that turns by `inclination` at most",
                            "`shortest`, `longest`: distances of the points of one body"])
    return drawing
