"""Drawings of gears-cams-ropes.md, from the geometry of teeth, cams and strands."""

from __future__ import annotations

import cmath
import math

import numpy as np
from drawing import Drawing, Panel, turned
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

PRESSURE = 20.0


def involute(angle: float) -> float:
    return math.tan(angle) - angle


def teeth(center: complex, radius: float, count: int, first: float, is_ring: bool = False) -> list[complex]:
    """The outline of a wheel with involute teeth, one of them in the direction `first`; of a ring its gaps are those
    teeth."""
    module = 2 * radius / count
    tip = radius + (1.2 if is_ring else 1.0) * module
    root = radius - (0.9 if is_ring else 1.2) * module
    base = radius * math.cos(math.radians(PRESSURE))
    half = math.pi / (2 * count) + involute(math.radians(PRESSURE))
    flank = [(max(root, base) + s * (tip - max(root, base))) for s in (0, 0.4, 0.75, 1)]
    sides = [(rho, half - involute(math.acos(base / rho))) for rho in flank]
    if root < base:
        sides.insert(0, (root, sides[0][1]))
    out = []
    for k in range(count):
        middle = math.radians(first) + 2 * math.pi * k / count
        out += [center + rho * cmath.exp(1j * (middle - a)) for rho, a in sides]
        out += [center + rho * cmath.exp(1j * (middle + a)) for rho, a in reversed(sides)]
    return out


def wheel(panel: Panel, center: complex, radius: float, count: int, first: float, style: str = "a") -> None:
    panel.area(teeth(center, radius, count, first), style)
    panel.circle(center, radius, "c")


def mark(panel: Panel, center: complex, radius: float, angle: float) -> None:
    panel.line(center, center + radius * turned(angle))
    panel.dot(center + radius * turned(angle))


def gear() -> Drawing:
    drawing = Drawing("Gear: ratio, phase and carrier", 338)
    a, b, r_a, r_b, angle, phase = 0, 160, 64.0, 96.0, 60.0, 80.0
    panel = drawing.panel(104 + 152j)
    wheel(panel, a, r_a, 16, angle)
    wheel(panel, b, r_b, 24, 180 + 7.5 - angle * r_a / r_b, "e")
    panel.line(a, b + 122, style="c")
    mark(panel, a, r_a - 14, angle)
    mark(panel, b, r_b - 16, phase - angle * r_a / r_b)
    panel.line(b, b + 102 * turned(phase), style="c")
    panel.turn(a, 34, 0, angle)
    panel.turn(b, 44, 0, phase, "d")
    panel.turn(b, 62, phase, phase - angle * r_a / r_b)
    panel.leader(35 * turned(12), 33 - 74j, "angle(a)", "middle")
    panel.text(b + 44 * turned(17), "`phase`", anchor="start", right=6)
    panel.leader(b + 64 * turned(62), b + 70 + 120j, "`ratio` · angle(a)", "middle")
    panel.pin(a)
    panel.pin(b)
    panel.dimension(a, r_a, "r_a", -112)
    panel.dimension(r_a, b, "r_b", -112)
    panel.text(-82, "a", down=4)
    panel.text(b + 110 - 26j, "b", down=4)
    panel.leader(24, 24 + 100j, "`carrier` c: the line of the shafts", "middle")
    panel.texts(-92 - 134j, ['`bodies` = ["a", "b"];  `ratio` = r_a / r_b = teeth of a / of b',
                             "angle(b) = `phase` - `ratio` · angle(a), both from the carrier",
                             "`backlash`: or up to half of it less or more"])
    return drawing


def gear_internal() -> Drawing:
    drawing = Drawing("Internal gear: a wheel in a ring, on a carrier", 250)
    panel = drawing.panel(118 + 125j)
    r_a, r_b, arm = 36.0, 96.0, 40.0
    center = (r_b - r_a) * turned(arm)
    panel.circle(0, r_b + 20, "e")
    panel.area(teeth(0, r_b, 40, arm, is_ring=True), "q")
    panel.circle(0, r_b, "c")
    wheel(panel, center, r_a, 15, arm)
    panel.link(0, center, style="q")
    mark(panel, center, r_a - 10, 150)
    panel.turn(center, 24, 230, 330)
    panel.turn(0, 76, 190, 250)
    panel.support(0)
    panel.pin(center)
    panel.dimension(0, center, "r_b - r_a", 26, where=0.2, aside=14)
    panel.text(center + 20 * turned(20), "a", down=4)
    panel.text(-106j, "b", down=4)
    panel.leader(0.45 * center - 5j, 62 - 22j, "c", "middle")
    panel.texts(128 + 86j, ['`internal` = true: a and b', "turn the same way", '`bodies` = ["a", "b"]; with a',
                            '  fixed ring ["a", "ground"]', '`carrier` = "c", the arm', "",
                            "angle(b) = `phase`", "  + `ratio` · angle(a),", "both from the carrier", "",
                            "`ratio` = r_a / r_b"], step=18)
    return drawing


def tooth_force() -> Drawing:
    drawing = Drawing("Tooth forces: pressure angle of gears and racks", 312)
    r_a, r_b = 54.0, 72.0
    panel = drawing.panel(124 + 130j)
    wheel(panel, complex(-r_a), r_a, 15, 0)
    wheel(panel, complex(r_b), r_b, 20, 180 + 9, "e")
    show_force(panel, 90, 90)
    panel.turn(-r_a, 26, 200, 320)
    panel.text(-r_a, "T on a", down=-10)
    panel.text(complex(r_b), "b", right=10, down=-10)
    panel.pin(complex(-r_a))
    panel.pin(complex(r_b))
    panel.line(complex(-r_a), complex(r_b), style="c")
    panel.text(-112 + 108j, "gear, force on b", anchor="start")
    panel.leader(0.8 * 90 * turned(80), 60 + 100j, "`pressure_angle`", "start")
    panel = drawing.panel(346 + 164j)
    wheel(panel, 56j, 56, 14, -90)
    rack_teeth(panel, 0, 8, 6)
    show_force(panel, 0, 72)
    panel.turn(56j, 26, 200, 320)
    panel.text(56j, "pinion", down=-10)
    panel.pin(56j)
    panel.text(-60 - 40j, "rack, force on it", anchor="start")
    panel.texts(-334 - 88j, ["`pressure_angle`: from the common tangent of the pitch circles",
                             "(dashed) to the force at the pitch point. Across the line of",
                             "centres it is T / r_a; its part along that line pushes apart."])
    return drawing


def show_force(panel: Panel, tangent: float, length: float) -> None:
    force = length * turned(tangent - PRESSURE)
    panel.line(-0.9 * length * turned(tangent), 1.1 * length * turned(tangent), style="c")
    panel.arrow(0, force)
    panel.turn(0, 0.8 * length, tangent, tangent - PRESSURE, "d")
    panel.dot(0)


def rack_teeth(panel: Panel, middle: float, module: float, count: int) -> None:
    """A rack below the line y = 0 with a gap at `middle`."""
    pitch, slope = math.pi * module, math.tan(math.radians(PRESSURE))
    low, high = -1.2 * module, module
    out = []
    for k in range(-count // 2, count // 2):
        tooth = middle + (k + 0.5) * pitch
        out += [complex(tooth - pitch / 4 + y * slope, y) for y in (low, high)]
        out += [complex(tooth + pitch / 4 - y * slope, y) for y in (high, low)]
    bottom = -2.6j * module
    panel.area([out[0] - 4, *out, out[-1] + 4, complex((out[-1] + 4).real) + bottom,
                complex((out[0] - 4).real) + bottom], "e")


def rack() -> Drawing:
    drawing = Drawing("Rack: radius, offset and travel", 312)
    panel = drawing.panel(142 + 176j)
    r, angle, module = 72.0, 40.0, 7.2
    rolled = r * math.radians(angle)
    wheel(panel, complex(0, r), r, 20, -90 + angle)
    rack_teeth(panel, rolled, module, 8)
    panel.line(complex(0, r), complex(0, r) + 66, style="c")
    mark(panel, complex(0, r), r - 14, angle)
    panel.turn(complex(0, r), 40, 0, angle)
    panel.text(complex(0, r) + 42 * turned(18), "angle", anchor="start", right=2)
    panel.pin(complex(0, r))
    panel.dimension(complex(0, r), 0, "`radius`", 0, where=0.5)
    first, start = -104 - 46j, 84.0
    panel.support(first)
    point = first + start + rolled
    panel.line(point, complex(point.real, -19), style="g")
    panel.pin(point)
    panel.dimension(first, first + start, "`offset`", -42, one=True)
    panel.dimension(first + start, point, "", -42, one=True)
    panel.text(point, "`radius` · angle(pinion)", anchor="start", right=10, down=46)
    panel.dimension(first, point, "travel", -68, one=True)
    panel.leader(point + 5, point + 60, "b.Q of the `slide`")
    panel.text(first, "a.P", right=-22, down=4)
    panel.arrow(rolled + 94 - 10j, rolled + 134 - 10j, "s")
    panel.dot(0)
    panel.texts(96 + 142j, ["`pinion`: turns on the", "`carrier`, by default", "the body of a.P",
                            "`radius` > 0: as drawn", "`radius` < 0: back", "`pressure_angle`: the",
                            "teeth press at the dot", "`backlash`: play along s"])
    return drawing


def geneva_outline(center: complex, slots: int, first: float, apart: float, pin: float) -> list[complex]:
    """A wheel with a slot in the direction `first`, degrees, and hollows for the locking disc between the slots."""
    half = math.pi / slots
    crank, rim = apart * math.sin(half), apart * math.cos(half)
    disc = crank - 2.2 * pin
    beside = math.asin(pin / rim)
    hollow = math.acos((apart ** 2 + rim ** 2 - disc ** 2) / (2 * apart * rim))
    of_disc = math.asin(rim * math.sin(hollow) / disc)
    out: list[complex] = []

    def arc(middle: complex, radius: float, begin: float, end: float) -> None:
        out.extend(middle + radius * cmath.exp(1j * angle) for angle in np.linspace(begin, end, 16))

    for k in range(slots):
        slot = math.radians(first) + 2 * half * k
        between = slot + half
        arc(center + (apart - crank) * cmath.exp(1j * slot), pin, slot + 1.5 * math.pi, slot + 0.5 * math.pi)
        arc(center, rim, slot + beside, between - hollow)
        arc(center + apart * cmath.exp(1j * between), disc, between + math.pi + of_disc, between + math.pi - of_disc)
        arc(center, rim, between + hollow, slot + 2 * half - beside)
    return out


def geneva() -> Drawing:
    drawing = Drawing("Geneva drive: slots, phase and offset", 330)
    slots, apart, pin, crank = 4, 150.0, 13.0, 24.0
    k = math.sin(math.pi / slots)
    r = apart * k
    panel = drawing.panel(122 + 138j)
    tip = r * turned(crank)
    psi = math.degrees(math.atan2(k * math.sin(math.radians(crank)), 1 - k * math.cos(math.radians(crank))))
    panel.area(geneva_outline(apart, slots, 180 - psi, apart, pin), "e")
    disc = r - 2.2 * pin
    ends = math.degrees(math.acos(k))
    cut = math.sqrt(apart ** 2 + disc ** 2 - 2 * apart * disc * k)
    of_cut = math.degrees(math.asin(disc * math.sin(math.radians(ends)) / cut))
    panel.area([*(disc * turned(crank + a) for a in np.linspace(ends, 360 - ends, 60)),
                *((apart + cut * turned(a)) * turned(crank) for a in np.linspace(180 + of_cut, 180 - of_cut, 20))], "a")
    panel.line(0, apart, style="c")
    panel.line(0, tip)
    panel.circle(tip, pin - 1, "a")
    panel.line(apart, apart + 1.06 * r * turned(180 - psi), style="c")
    panel.turn(0, 46, 0, crank)
    panel.turn(apart, 40, 180, 180 - psi)
    panel.leader(47 * turned(10), 40 + 104j, "angle(crank) - `phase`", "middle")
    panel.leader(apart + 41 * turned(180 - 0.5 * psi), apart - 10 + 106j, "psi", "middle")
    panel.leader(disc * turned(200), -76 - 84j, "locking disc", "middle")
    panel.pin(0)
    panel.pin(complex(apart))
    panel.dimension(0, complex(apart), "c", -104)
    panel.text(complex(apart + 44, 2), "wheel", down=4)
    panel.texts(-110 - 124j, ["r = c sin(pi / n), so that the pin enters along the slot;",
                              "each turn moves the wheel by 2 pi / n",
                              '`bodies` = ["crank", "wheel"] on `carrier`; n = `slots`',
                              "`offset`: the wheel's angle where psi = 0, in turn 0"])
    return drawing


def strand(c_a: complex, c_b: complex, r_a: float, r_b: float) -> tuple[complex, complex]:
    """Ends of the straight strand between two wheels; radii are positive where it passes counter-clockwise."""
    d, over = c_b - c_a, r_b - r_a
    t = d * complex(math.sqrt(abs(d) ** 2 - over ** 2), -over) / abs(d) ** 2
    return c_a - 1j * t * r_a, c_b - 1j * t * r_b


def degrees(p: complex) -> float:
    return math.degrees(cmath.phase(p))


def belt() -> Drawing:
    drawing = Drawing("Belt: open and crossed", 232)
    for x, is_crossed in ((42, False), (258, True)):
        panel = drawing.panel(x + 90j)
        b, r_a, r_b = 114.0, 28.0, 42.0
        sense = -1 if is_crossed else 1
        panel.circle(0, r_a, "a")
        panel.circle(b, r_b, "e")
        ends = [strand(0, b, side * r_a, side * sense * r_b) for side in (1, -1)]
        for p, q in ends:
            panel.line(p, q, style="w")
        (lower, on_b), (upper, _) = ends
        panel.arc(0, r_a, degrees(upper) % 360, degrees(lower) % 360, "w")
        half = abs(degrees(on_b - b))
        panel.arc(b, r_b, -half, half, "w")
        panel.line(0, b, style="c")
        panel.turn(0, 17, 200, 340)
        panel.turn(b, 28, 330, 210) if is_crossed else panel.turn(b, 28, 210, 330)
        panel.pin(0)
        panel.pin(b)
        panel.text(0, "a", down=-9)
        panel.text(b, "b", down=-9)
        panel.line(0, r_a * turned(120), style="d")
        panel.line(b, b + r_b * turned(60), style="d")
        panel.text(36 * turned(120), "r_a", down=2)
        panel.text(b + 52 * turned(60), "r_b", right=4, down=4)
        panel.text(b / 2 - 66j, "`crossed` = true" if is_crossed else "open belt")
    panel.texts(-244 - 98j, ['`bodies` = ["a", "b"] on the `carrier`;  `ratio` = r_a / r_b',
                             "open: angle(b) = `phase` + `ratio` · angle(a);  crossed: - for +"])
    return drawing


def coupling() -> Drawing:
    drawing = Drawing("Coupling: a sum of factors times measures", 206)
    panel = drawing.panel(34 + 78j)
    panel.ground(-10 - 16j, 150 - 16j)
    panel.block(90, 180, 30)
    panel.block(150, 180, 20, style="e")
    panel.block(210, 180, 10, style="q")
    panel.line(0, -40j, style="x")
    for x, y in ((60, 0), (120, 0)):
        panel.line(complex(x), complex(x, 44), style="x")
    panel.line(44j, 0, style="x")
    panel.dimension(36j, 60 + 36j, "s_1", one=True)
    panel.dimension(60 + 36j, 120 + 36j, "s_2", one=True)
    panel.text(312 - 0j, "two slides", anchor="start", down=4)
    panel.text(150 + 52j, "travels of `slide` = \"1\" and \"2\"", anchor="start")
    panel.texts(-24 - 62j, ["`sum` = [{ factor = 1, slide = \"1\" }, { factor = -1, slide = \"2\" }]",
                            "`value` = 0:   1 · s_1 - 1 · s_2 = 0, both stages extend alike"], step=22)
    return drawing


def cam_share(turn: NDArray[np.float64]) -> NDArray[np.float64]:
    """The law of the example: a rise by the polynomial 3-4-5, a dwell, a cycloidal return, a dwell."""
    u = np.mod(turn, 360.0)
    s = np.clip(u / 120, 0, 1)
    rise = s ** 3 * (10 - 15 * s + 6 * s ** 2)
    back = np.clip((u - 180) / 120, 0, 1)
    return np.asarray(rise - (back - np.sin(2 * np.pi * back) / (2 * np.pi)))


def cam() -> Drawing:
    drawing = Drawing("Cam: base, lift, roller and pressure angle", 426)
    panel = drawing.panel(184 + 250j)
    base, lift, roller, at = 70.0, 66.0, 16.0, 52.0
    turns = np.linspace(0, 360, 721)
    pitch = (base + lift * cam_share(turns)) * np.exp(1j * np.radians(90 + at - turns))
    slope = np.gradient(pitch)
    slope[0] = slope[-1] = (pitch[1] - pitch[-2]) / 2
    surface = pitch - roller * 1j * slope / np.abs(slope)
    panel.area([complex(p) for p in surface[::8]])
    panel.line(*(complex(p) for p in pitch[::8]), style="c")
    panel.circle(0, base, "x")
    center = complex(pitch[round(2 * at)])
    normal = complex(1j * slope[round(2 * at)] / abs(slope[round(2 * at)]))
    panel.line(0, 234j, style="c")
    panel.link(center, center + 58j, 6, "e")
    panel.circle(center, roller, "q")
    panel.pin(center)
    for side in (1, -1):
        panel.ground(center + complex(side * 8, 44 - side * 11), center + complex(side * 8, 44 + side * 11))
    panel.support(0)
    # The angle of the cam, its profile, the pressure angle.
    panel.line(0, 1.12 * complex(pitch[0]), style="c")
    panel.turn(0, 40, 90, 90 + at)
    panel.leader(41 * turned(90 + 0.8 * at), -74 + 36j, "angle - `phase`", "end")
    panel.leader(1.12 * complex(pitch[0]), -100 + 84j, "the profile begins", "middle")
    panel.arrow(center, center + 84 * normal)
    panel.text(center + 92 * normal, "normal force", right=-52, down=2)
    mu = degrees(normal)
    panel.turn(center, 62, 90, mu, "d")
    panel.leader(center + 63 * turned((90 + mu) / 2), center - 62 + 106j, "pressure angle", "middle")
    # Dimensions, from the shaft.
    share = float(cam_share(np.array([at]))[0])
    right = 84.0
    for height in (base, center.imag, base + lift):
        panel.line(complex(0, height), complex(right + 12, height), style="x")
    panel.line(0, right + 12, style="x")
    panel.dimension(complex(right), complex(right, base), "`base`")
    panel.dimension(complex(right, base), complex(right, center.imag), "")
    panel.leader(complex(right, (base + center.imag) / 2), complex(right + 16, base + lift + 14),
                 f"{share:.2f} · `lift`")
    panel.dimension(complex(right + 60, base), complex(right + 60, base + lift), "`lift`")
    panel.line(complex(right + 12, base), complex(right + 72, base), style="x")
    panel.line(complex(right + 12, base + lift), complex(right + 72, base + lift), style="x")
    panel.dimension(complex(right + 118), complex(right + 118, center.imag), "`follower`", one=True)
    panel.line(complex(right + 12, center.imag), complex(right + 130, center.imag), style="x")
    panel.line(complex(right + 12), complex(right + 130), style="x")
    panel.leader(center + 2 + 2j, center + 36 + 92j, '`roller` = "b.P", its centre', "start")
    panel.leader(complex(pitch[350]), complex(pitch[350]) + 24 - 14j, "pitch curve")
    panel.text(20 - 92j, "cam")
    panel.texts(-172 - 132j, ['`bodies` = ["ground", "cam"]: the angle of the cam',
                              "`guided` = true: the roller runs in a groove, no lift-off",
                              "`friction` of an edge at `roller`; `restitution` of impacts"])
    return drawing


def cam_law() -> Drawing:
    drawing = Drawing("Lift curve of a cam: law, curve and phase", 382)
    marks = {0: "0", 90: "90", 180: "180", 270: "270", 360: "360"}

    def axes(origin: complex) -> Panel:
        panel = drawing.panel(origin)
        panel.arrow(-6, 380, "g", "m", 6)
        panel.arrow(-6j, 116j, "g", "m", 6)
        panel.line(90j, 360 + 90j, style="x")
        for angle, name in marks.items():
            panel.line(angle, angle - 4j, style="g")
            panel.text(angle, name, "n", down=17)
        panel.text(90j, "1", "n", "end", right=-6, down=4)
        panel.text(0, "0", "n", "end", right=-6, down=4)
        return panel

    panel = axes(34 + 142j)
    u = np.linspace(0, 1, 25)
    parts = [(0, 110, 0, 1, "polynomial_345", u ** 3 * (10 - 15 * u + 6 * u ** 2)),
             (110, 170, 1, 1, "dwell", 0 * u),
             (170, 260, 1, 0.4, "harmonic", (1 - np.cos(np.pi * u)) / 2),
             (260, 360, 0.4, 0, "cycloidal", u - np.sin(2 * np.pi * u) / (2 * np.pi))]
    for begin, end, first, last, law, share in parts:
        panel.line(*(complex(begin + s * (end - begin), 90 * (first + p * (last - first))) for s, p in zip(u, share)),
                   style="w")
        panel.line(complex(end), complex(end, 98), style="c")
        panel.dot(complex(end, 90 * last))
    panel.text(8 + 98j, "`polynomial_345`", anchor="start")
    panel.text(140 + 76j, "`dwell`")
    panel.text(208 + 60j, "`harmonic`", "", "end", down=6)
    panel.text(318 + 34j, "`cycloidal`", down=-4)
    panel.text(260 + 36j, "`to` = 260", "", "end", right=-4, down=34)
    panel.text(260 + 36j, "`lift` = 0.4", "", "start", right=6, down=-38)
    panel.text(-24 + 128j, "`law`: share P over the angle - `phase`, in parts", anchor="start")
    panel = axes(34 + 304j)
    points = np.array([[0, 0.15], [60, 0.2], [110, 0.8], [160, 1.0], [200, 0.9], [250, 0.45], [300, 0.15], [360, 0.15]])
    spline = CubicSpline(points[:, 0], points[:, 1], bc_type="periodic")
    panel.line(*(complex(x, 90 * float(spline(x))) for x in np.linspace(0, 360, 91)), style="w")
    for x, y in points:
        panel.dot(complex(x, 90 * y))
    panel.leader(250 + 0.45j * 90, 276 + 72j, "[`ANGLE`, `SHARE`]", "start")
    panel.text(-24 + 128j, "`curve`: periodic spline through points", anchor="start")
    panel.texts(-24 - 46j, ["follower = `base` + `lift` · P(angle - `phase`)",
                            "`phase` = 30: the profile begins at the angle 30"])
    return drawing


def rope() -> Drawing:
    drawing = Drawing("Rope: over points and pulleys, length, stiffness", 360)
    panel = drawing.panel(50 + 176j)
    path = [(0j, 0.0), (120 + 92j, -30.0), (222 + 22j, 20.0), (330 + 96j, 0.0)]
    ends = [strand(path[k][0], path[k + 1][0], path[k][1], path[k + 1][1]) for k in range(3)]
    for k in (1, 2):
        panel.circle(path[k][0], abs(path[k][1]), "a")
    for p, q in ends:
        panel.line(p, q, style="w")
    for k in (1, 2):
        center, radius = path[k]
        first, last = degrees(ends[k - 1][1] - center), degrees(ends[k][0] - center)
        panel.arc(center, abs(radius), first, last, "w")
        panel.pin(center)
    panel.support(0)
    panel.block(path[3][0] + 17, 34, 26, style="e")
    panel.pin(path[3][0])
    top, low = path[1][0], path[2][0]
    panel.line(top, top + 30 * turned(215), style="d")
    panel.text(top + 15 * turned(215), "`radius`", "", "end", right=-24, down=14)
    panel.turn(top, 41, 120, 45)
    panel.text(top + 46j, '`turn` = "clockwise"', right=10, down=-6)
    panel.turn(low, 31, 240, 310)
    panel.text(low - 36j, '"counterclockwise"', right=6, down=10)
    panel.leader(top, top + 70 + 2j, '`pulley` = "b.Q"', "start")
    panel.leader(low, low + 46 - 4j, "`friction` = MU", "start")
    panel.text(0, '"a.P"', right=-20, down=-12)
    panel.text(path[3][0] + 17, '"c.R"', down=-19)
    panel.texts(-30 - 56j, ['`over` = ["a.P", { pulley = "b.Q", ... }, { ... }, "c.R"]',
                            "its length g: straight parts + arcs on the rims"])
    for x, is_stretching in ((10, False), (222, True)):
        chart = drawing.panel(x + 30 + 346j)
        chart.arrow(0, 168, "g", "m", 6)
        chart.arrow(0, 74j, "g", "m", 6)
        chart.text(168, "g", "n", right=-4, down=-7)
        chart.text(72j, "tension", "n", "start", right=8, down=2)
        if is_stretching:
            chart.line(0, 66, 140 + 62j, style="w")
            chart.line(100 + 28.5j, 128 + 28.5j, 128 + 52j, style="d")
            chart.text(132 + 38j, "`stiffness`", anchor="middle", right=10)
            chart.dot(66)
            chart.text(66, "`free_length`", down=-9, right=-8)
        else:
            chart.line(0, 92, 92 + 64j, style="w")
            chart.dot(92)
            chart.text(98 + 12j, "`length`", anchor="start")
            chart.text(6 + 10j, "slack", "n", "start", right=10)
    return drawing


def chain() -> Drawing:
    drawing = Drawing("Chain: the strand, its length and angle", 404)
    panel = drawing.panel(82 + 214j)
    c_a, c_b, r_a, r_b = 0j, 220 + 120j, 36.0, 60.0
    for center, radius, shaft, style in ((c_a, r_a, -14 + 10j, "a"), (c_b, r_b, 24 + 12j, "e")):
        panel.circle(center, radius + 5, "x")
        panel.circle(center, radius, style)
        panel.support(center + shaft)
        panel.dot(center)
    tight, other = strand(c_a, c_b, r_a, r_b), strand(c_a, c_b, -r_a, -r_b)
    crossing = strand(c_a, c_b, r_a, -r_b)
    panel.line(*crossing, style="x")
    panel.line(*other, style="c")
    panel.line(*tight, style="w")
    psi = degrees(tight[1] - tight[0])
    panel.dimension(tight[0], tight[1], "l", -24, where=0.72)
    panel.line(tight[0], tight[0] + 110, style="c")
    panel.turn(tight[0], 92, 0, psi, "d")
    panel.text(tight[0] + 104 * turned(psi / 2), "psi", anchor="start", down=4)
    for center, point, name in ((c_a, tight[0], "R_a"), (c_b, tight[1], "R_b")):
        panel.line(center, point, style="d")
        panel.text((center + point) / 2, name, anchor="start", right=4, down=4)
    panel.turn(c_a, r_a + 15, 200, 285)
    panel.text(c_a - 74 - 72j, '`turn` = "counterclockwise"', anchor="start")
    panel.leader(0.5 * (other[0] + other[1]), 40 + 150j, '`turn` = "clockwise"', "middle")
    panel.leader(0.75 * crossing[0] + 0.25 * crossing[1], -14 + 118j, "`crossed` = true", "middle")
    panel.leader(c_a, -26 + 60j, '`a` = "a.C"', "middle")
    panel.leader(c_b, c_b + 66 + 58j, '`b` = "b.C"', "middle")
    panel.texts(-70 - 112j, ["|R_a| = `radius_a`, |R_b| = `radius_b`; positive with the strand",
                             "on the right of the centre, on its way from a to b",
                             "l + R_a (psi - angle(a)) - R_b (psi - angle(b)) = `length`,",
                             "or less with `slack` = true"])
    return drawing
