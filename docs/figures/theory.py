"""Drawings of the pages of theory: phasors, settling, the interval Newton operator."""

from __future__ import annotations

import numpy as np
from drawing import Drawing, turned


def phasors() -> Drawing:
    drawing = Drawing("A four-bar as two sums of phasors", 262)
    panel = drawing.panel(50 + 188j)
    ground, crank, coupler, rocker = 190 + 0j, 74 * turned(66), 166 * turned(20), 112 * turned(72)
    tip, other = crank + coupler, ground + rocker
    panel.line(tip, other, style="x")
    for begin, end, name, angle, size in ((0j, crank, "c_1 φ_1", 66.0, 28.0), (crank, tip, "c_2 φ_2", 20.0, 44.0),
                                          (ground, other, "c_3 φ_3", 72.0, 28.0)):
        panel.line(begin, begin + size + 12, style="c")
        panel.turn(begin, size, 0, angle, "d")
        panel.arrow(begin, end, "w", "m", 9)
        panel.text((begin + end) / 2, name, right=-6, down=-6)
    panel.text(32 * turned(30), "q_1", anchor="start", right=3)
    panel.text(crank + 50 * turned(8), "q_2", anchor="start", right=2, down=3)
    panel.text(ground + 32 * turned(30), "q_3", anchor="start", right=3)
    panel.arrow(0, ground, "g", "m", 8)
    panel.text(ground / 2, "c_0", down=-6)
    panel.support(0)
    panel.support(ground)
    panel.dot(tip)
    panel.dot(other)
    panel.leader(tip, tip - 30 + 36j, "p_a = c_1 φ_1 + c_2 φ_2", "middle")
    panel.leader(other, other + 44 - 26j, "p_b = c_0 + c_3 φ_3")
    panel.texts(-38 - 46j, ["φ_k = exp(i q_k): an arrow of length 1 at the angle q_k", "closed: p_b - p_a = 0"])
    return drawing


def settling() -> Drawing:
    drawing = Drawing("Settling: downhill to the first pose that holds", 270)
    panel = drawing.panel(30 + 222j)

    def energy(at: float) -> float:
        u = (at - 190) / 118
        return 126 + 62 * (u ** 4 - 2 * u ** 2) - 16 * u

    panel.arrow(-4, 396, "g", "m", 6)
    panel.arrow(-4j, 196j, "g", "m", 6)
    panel.text(196j, "energy V", "n", "start", right=6, down=4)
    panel.text(396, "s, along the closed poses", "n", "end", down=16)
    panel.line(*(complex(s, energy(s)) for s in np.linspace(18, 362, 90)), style="w")
    left = min(np.linspace(20, 180, 400), key=energy)
    right = min(np.linspace(200, 360, 400), key=energy)
    top = max(np.linspace(left, right, 400), key=energy)
    for s, name in ((left, "rests here: r = 0"), (right, "another equilibrium")):
        panel.dot(complex(s, energy(s)), 5)
        panel.text(complex(s, energy(s)), name, down=24)
    panel.line(complex(top), complex(top, 168), style="c")
    panel.text(complex(top, 174), "watershed")
    start = 140.0
    panel.circle(complex(start - 2, energy(start) + 8), 7, "a")
    panel.text(complex(start, energy(start) + 20), "start", right=14, down=-2)
    way = [complex(s, energy(s) + 14) for s in np.linspace(start - 12, left + 12, 12)]
    panel.line(*way, style="s")
    panel.arrow(way[-2], way[-1], "s")
    panel.leader(way[5], way[5] - 20 + 52j, "force r = -dV/ds", "middle")
    return drawing


def interval_newton() -> Drawing:
    drawing = Drawing("The box X and its image N", 214)
    panel = drawing.panel(50 + 172j)
    panel.arrow(-10, 330, "g", "m", 6)
    panel.arrow(-10j, 158j, "g", "m", 6)
    panel.text(330, "x_1", "n", down=16)
    panel.text(158j, "x_2", "n", right=-14, down=6)
    panel.block(140 + 80j, 220, 128)
    panel.block(152 + 74j, 66, 40, style="e")
    panel.circle(140 + 80j, 3, "q")
    panel.dot(159 + 71j)
    panel.text(38 + 132j, "X", anchor="start", right=-2)
    panel.text(124 + 82j, "N", anchor="start", right=2, down=-2)
    panel.leader(140 + 80j, 104 + 118j, "m", "middle")
    panel.leader(159 + 71j, 258 + 108j, "the equilibrium")
    panel.text(262 + 60j, "N inside X:", anchor="start")
    panel.text(262 + 60j, "exactly one in X,", anchor="start", down=17)
    panel.text(262 + 60j, "and it is in N", anchor="start", down=34)
    panel.dimension(30 + 4j, 140 + 4j, "1e-10", 0)
    return drawing


def balance() -> Drawing:
    drawing = Drawing("A weight balanced by a spring of free length zero", 290)
    panel = drawing.panel(140 + 196j)
    t = turned(34)
    hook, hold, weight = 122j, 96 * t, 190 * t
    panel.line(0, 150j, style="c")
    panel.link(0, weight, 7)
    panel.spring(hook, hold, 7)
    panel.support(0)
    panel.dot(hook)
    panel.pin(hold)
    panel.circle(weight, 9, "m")
    panel.arrow(weight - 8j, weight - 58j)
    panel.text(weight - 64j, "m g", down=8)
    panel.dimension(0j, hook, "h", 26)
    panel.dimension(0j, hold, "a", -24, where=0.7)
    panel.dimension(0j, weight, "l", -48)
    panel.turn(0, 40, 0, 34, "s")
    panel.line(0, 56, style="c")
    panel.text(44 * turned(15), "q", anchor="start", right=2, down=4)
    panel.text((hook + hold) / 2, "k, free length 0", anchor="start", right=10, down=-6)
    panel.texts(-126 - 60j, ["V = m g l sin q + k/2 (h² + a² - 2 h a sin q)",
                             "constant in all poses where k h a = m g l"], step=20)
    return drawing


def poses() -> Drawing:
    drawing = Drawing("A link that holds a point of a body in all poses", 276)
    panel = drawing.panel(46 + 196j)
    pivot, length = 150 + 24j, 118.0
    w = 34 + 16j
    panel.arc(pivot, length, -12, 196, "c")
    for k, (around, angle) in enumerate(((128.0, 8.0), (92.0, -14.0), (58.0, -34.0))):
        pin, t = pivot + length * turned(around), turned(angle)
        d = pin - t * w
        panel.area([d + t * p for p in (-8 - 8j, 62 - 8j, 62 + 26j, -8 + 26j)], "a" if k == 2 else "q")
        panel.line(d, d + 18 * t, style="g")
        panel.line(d, d + 18j * t, style="g")
        panel.dot(d, 2.4)
        panel.line(pivot, pin, style="o" if k == 2 else "c")
        panel.pin(pin)
        if k == 2:
            panel.arrow(0, d, "d")
            panel.text(d / 2, "d", right=-2, down=-6)
            panel.leader(pin, pin + 52 + 22j, "pin w, in the body")
    panel.frame(0, size=30)
    panel.support(pivot)
    panel.text(pivot, "pivot u", anchor="start", right=20, down=6)
    panel.text(pivot + 0.55 * length * turned(58), "L", anchor="start", right=8)
    panel.texts(-32 - 62j, ["|d + R w - u| = L in every pose: the pin stays on a circle"])
    return drawing


def four_bar() -> Drawing:
    drawing = Drawing("A four-bar that computes a function", 236)
    panel = drawing.panel(84 + 178j)
    ground, a, c, phi, psi = 190 + 0j, 78.0, 112.0, 72.0, 58.0
    p, q = a * turned(phi), ground + c * turned(psi)
    panel.line(0, ground, style="c")
    panel.link(0, p, 6)
    panel.link(p, q, 6, "q")
    panel.link(ground, q, 6, "e")
    panel.support(0)
    panel.support(ground)
    panel.pin(p)
    panel.pin(q)
    panel.line(ground, ground + 60, style="c")
    panel.turn(0, 44, 0, phi)
    panel.turn(ground, 44, 0, psi)
    panel.text(50 * turned(32), "φ, input: x", anchor="start", right=2)
    panel.text(ground + 50 * turned(28), "ψ, output: y", anchor="start", right=2)
    panel.text(p / 2, "a", right=-16)
    panel.text((p + q) / 2, "b", down=-12)
    panel.text((ground + q) / 2, "c", anchor="start", right=12)
    panel.text(ground / 2, "g", down=-6)
    panel.text(-70 - 44j, "angles count from the line from the input's pivot to the output's", anchor="start")
    return drawing
