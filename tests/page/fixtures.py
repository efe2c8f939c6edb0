#!/usr/bin/env python3
"""Writes documents for tests of the page, and their pages: fixtures.py FOLDER

Shapes are drawn here in the way of app/draw/, only as far as the page needs it."""

import json
import math
import pathlib
import random
import sys

from assemble import page

PALETTE = {
    "paper": ["#ffffff", "#161d22"],
    "dark": ["#2b343c", "#dfe6eb"],
    "ground": ["#59636c", "#98a5af"],
    "ghost": ["#d3d8dd", "#3b4750"],
    "pale": ["#eef1f3", "#29333b"],
    "load": ["#c8202b", "#ff7d80"],
    "reaction": ["#1f5fb4", "#7db6f8"],
    "drive": ["#a3247f", "#ec8ad2"],
    "spring": ["#2f7d4f", "#6cc890"],
    "slack": ["#8fa99a", "#5d7a69"],
    "damper": ["#7a4fa3", "#be9bea"],
    "stop": ["#d9730d", "#ff9c47"],
    "free-stop": ["#a9b0b7", "#66727c"],
    "faint": ["#667079", "#97a4ae"],
    "good": ["#1b7340", "#62cf8e"],
    "bad": ["#b3261e", "#ff8d86"],
    "doubtful": ["#8a5200", "#f0b653"],
    "grid": ["#e6eaee", "#29333a"],
    "band": ["#e9f0f7", "#1f2e3c"],
    "body-1": ["#9fb1c4", "#566d86"],
    "body-2": ["#d3b27c", "#876a35"],
    "body-3": ["#93b795", "#4c774f"],
    "body-4": ["#bf9fc0", "#7b5a7d"],
    "body-5": ["#b7b48a", "#716d3c"],
    "body-6": ["#dba58f", "#925b46"],
    "body-7": ["#8fbcc0", "#44777b"],
    "body-8": ["#c7b8a3", "#7a6a54"],
    "body-9": ["#a9a7cf", "#625f99"],
    "curve-1": ["#0072b2", "#4a86f0"],
    "curve-2": ["#e69f00", "#f0b030"],
    "curve-3": ["#cc79a7", "#d989b8"],
    "curve-4": ["#d55e00", "#f2703a"],
    "curve-5": ["#2b343c", "#dfe6eb"],
    "curve-6": ["#56b4e9", "#56b4e9"],
    "curve-7": ["#009e73", "#1fae80"],
}


class Canvas:
    """The slots and shapes of one frame, in px."""

    def __init__(self, pool):
        self.pool, self.frame = pool, []

    def add(self, layer, name, shape):
        self.frame.append(((layer, name), self.pool.shape(shape)))

    def line(self, layer, name, a, b, **style):
        self.add(layer, name, ["line", self.pool.style(**style), *rounded(*a, *b)])

    def bar(self, name, a, b, fill, width=11):
        self.line("bodies", name, a, b, stroke="dark", width=width)
        self.line("bodies", name, a, b, stroke=fill, width=width - 2.4)

    def many(self, kind, layer, name, points, **style):
        flat = rounded(*[c for p in points for c in p])
        self.add(layer, name, [kind, self.pool.style(**style), flat])

    def circle(self, layer, name, at, r, **style):
        self.add(layer, name, ["circle", self.pool.style(**style), *rounded(*at, r)])

    def text(self, layer, at, text, colour="dark", size=11, align="start", **more):
        style = {"size": size, "colour": colour, "bold": False, "italic": False, "halo": True, "align": align} | more
        self.add(layer, "", ["text", self.pool.style_of(style), *rounded(*at), text])

    def pin(self, name, at):
        self.circle("joints", name, at, 4.5, fill="paper", stroke="dark", width=1.6)

    def support(self, name, at):
        x, y = at
        self.many(
            "polygon",
            "ground",
            name,
            [(x, y), (x - 10, y + 17), (x + 10, y + 17)],
            fill="pale",
            stroke="dark",
            width=1.4,
        )
        for i in range(5):
            px = x - 14 + 7 * i
            self.line("ground", name, (px, y + 17), (px - 6, y + 23), stroke="ground", width=0.9)
        self.line("ground", name, (x - 17, y + 17), (x + 17, y + 17), stroke="dark", width=1.6)

    def arrow(self, layer, name, tail, tip, colour, width=2.2):
        length = math.dist(tail, tip) or 1.0
        u = ((tip[0] - tail[0]) / length, (tip[1] - tail[1]) / length)
        head = min(5 + 2.6 * width, 0.8 * length)
        back = (tip[0] - head * u[0], tip[1] - head * u[1])
        side = (0.36 * head * -u[1], 0.36 * head * u[0])
        self.line(
            layer, name, tail, (back[0] + 0.2 * head * u[0], back[1] + 0.2 * head * u[1]), stroke=colour, width=width
        )
        self.many(
            "polygon",
            layer,
            name,
            [tip, (back[0] + side[0], back[1] + side[1]), (back[0] - side[0], back[1] - side[1])],
            fill=colour,
            stroke=colour,
            width=0.6,
        )

    def spring(self, name, a, b):
        length = math.dist(a, b)
        u = ((b[0] - a[0]) / length, (b[1] - a[1]) / length)
        teeth = 12
        points = [a]
        for i in range(teeth):
            along = 20 + (i + 0.5) * (length - 40) / teeth
            side = 6 if i % 2 else -6
            points.append((a[0] + along * u[0] - side * u[1], a[1] + along * u[1] + side * u[0]))
        self.many("polyline", "springs-and-dampers", name, points + [b], stroke="spring", width=1.8)


class Pool:
    def __init__(self):
        self.shapes, self.styles, self.shape_places, self.style_places = [], [], {}, {}

    def _place(self, of, places, what):
        key = json.dumps(what)
        if key not in places:
            places[key] = len(of)
            of.append(what)
        return places[key]

    def shape(self, shape):
        return self._place(self.shapes, self.shape_places, shape)

    def style_of(self, style):
        return self._place(self.styles, self.style_places, style)

    def style(self, fill="none", stroke="none", width=1.0, dash="", opacity=1):
        return self.style_of({"fill": fill, "stroke": stroke, "width": width, "dash": dash, "opacity": opacity})


def rounded(*numbers):
    return [round(x, 2) for x in numbers]


def drawing(frames, pool, width, height, description, **more):
    """Frames as differences. All frames here have the same slots."""
    slots = [list(slot) for slot, _ in frames[0].frame]
    states = [[shape for _, shape in canvas.frame] for canvas in frames]
    changes = [states[0]]
    for before, now in zip(states, states[1:]):
        changes.append([x for i, (a, b) in enumerate(zip(before, now)) if a != b for x in (i, b)])
    return {
        "width": width,
        "height": height,
        "description": description,
        "styles": pool.styles,
        "slots": slots,
        "shapes": pool.shapes,
        "frames": changes,
        "captions": [],
        "tones": [],
        "confirmed": [True] * len(frames),
    } | more


class FourBar:
    """A four-bar in m with its crank at an angle, on a page of 900 x 560 px."""

    def __init__(self, angle, scale=900.0, origin=(300.0, 400.0)):
        self.a, self.d = (0.0, 0.0), (0.3, 0.0)
        self.b = (0.1 * math.cos(angle), 0.1 * math.sin(angle))
        l, r = 0.28, 0.22
        dx, dy = self.d[0] - self.b[0], self.d[1] - self.b[1]
        dist = math.hypot(dx, dy)
        along = (dist * dist + l * l - r * r) / (2 * dist)
        up = math.sqrt(max(0.0, l * l - along * along))
        self.c = (self.b[0] + (along * dx - up * dy) / dist, self.b[1] + (along * dy + up * dx) / dist)
        cx, cy = self.c[0] - self.b[0], self.c[1] - self.b[1]
        self.p = (self.b[0] + 0.5 * cx - 0.2 * cy, self.b[1] + 0.5 * cy + 0.2 * cx)
        self.angle, self.coupler = angle, math.atan2(cy, cx)
        self.rocker = math.atan2(self.c[1], self.c[0] - 0.3)
        self.px = lambda q: (origin[0] + scale * q[0], origin[1] - scale * q[1])

    def draw(self, canvas, forces=True, names=True):
        a, b, c, d, p = (self.px(q) for q in (self.a, self.b, self.c, self.d, self.p))
        canvas.support("A", a)
        canvas.support("D", d)
        canvas.many("polygon", "bodies", "coupler", [b, c, p], fill="body-2", opacity=0.3)
        canvas.bar("crank", a, b, "body-1")
        canvas.bar("coupler", b, c, "body-2")
        canvas.bar("coupler", c, p, "body-2", 8)
        canvas.bar("coupler", p, b, "body-2", 8)
        canvas.bar("rocker", d, c, "body-3")
        canvas.spring("holder", (a[0], a[1] - 225), b)
        for name, at in zip("ABCD", (a, b, c, d)):
            canvas.pin(name, at)
        canvas.add("drives", "motor", ["arc", canvas.pool.style(stroke="drive", width=2), *rounded(*a, 26, -0.6, 2.6)])
        if forces:
            canvas.arrow("reactions", "A", (a[0] - 12, a[1] + 110), (a[0] - 2, a[1] + 30), "reaction")
            canvas.arrow("reactions", "D", (d[0] + 40, d[1] + 90), (d[0] + 4, d[1] + 30), "reaction")
            canvas.arrow("loads", "load", (p[0], p[1] - 80), p, "load")
        if names:
            canvas.text("labels", (b[0] - 12, b[1] - 12), "B", align="end")
            canvas.text("labels", (c[0] + 12, c[1] - 8), "C")
            canvas.text("labels", (0.5 * (c[0] + d[0]) + 14, 0.5 * (c[1] + d[1])), "rocker", "faint", italic=True)
            if forces:
                canvas.text("loads", (p[0] + 8, p[1] - 62), "load 200 N", "load")
                canvas.text("reactions", (a[0] - 18, a[1] + 96), "118 N", "reaction", align="end")
                canvas.text("reactions", (d[0] + 48, d[1] + 92), "80.2 N", "reaction")


def column(title, cells, unit="", values=None, tones=None):
    made = {"title": title, "unit": unit, "align": "right" if values is not None else "left", "cells": cells}
    return made | ({"values": values} if values is not None else {}) | ({"tones": tones} if tones else {})


def numbers(title, unit, values, decimals=3):
    cells = ["-" if v is None else f"{v:.{decimals}f}".replace("-", "−") for v in values]
    return column(title, cells, unit, values)


def table(title, columns, footnotes=(), level="normal"):
    return {"kind": "table", "title": title, "level": level, "footnotes": list(footnotes), "columns": columns}


def fact(label, text, tone="plain", level="normal"):
    return {"kind": "fact", "label": label, "text": text, "tone": tone, "level": level}


def document(command, title, verdict, figures, report, **more):
    return {
        "poise": "0.1.0",
        "command": command,
        "line": f"poise {command} datasets/four_bar.toml --set load.load=250",
        "title": title,
        "source": "ours",
        "verdict": verdict,
        "warnings": [],
        "palette": PALETTE,
        "figures": figures,
        "report": report,
        "result": {"title": title, "seed": 2**64 - 1, "braces": '}"{,', "angles": {"crank": [1.6358, 1]}},
    } | more


def force_table():
    return table(
        "Joint forces on the named body, along world axes",
        [
            column("joint", list("ABCD")),
            column("kind", ["pin"] * 4),
            column("on", ["crank", "coupler", "rocker", "rocker"]),
            numbers("Fx", "N", [7.672, 18.552, 18.552, -18.552]),
            numbers("Fy", "N", [-117.816, 133.708, -78.064, 78.064]),
            numbers("|F|", "N", [118.066, 134.989, 80.238, 80.238]),
        ],
        ["A joint that carries more than one body is listed once for each."],
    )


def solve():
    pool = Pool()
    canvas = Canvas(pool)
    FourBar(1.1).draw(canvas)
    canvas.text("heading", (28, 40), "g = 9810 mm/s²", "faint")
    still = drawing(
        [canvas],
        pool,
        900,
        560,
        "Four-bar in equilibrium with the forces of its joints",
        captions=["In equilibrium, proved: stable"],
        tones=["good"],
    )
    report = [
        fact("reached", "from the start when released with heavy damping"),
        fact("energy", "50738.7 N mm, lowest of three equilibria"),
        fact("proof", "the only equilibrium within 0.0123 deg of this one", "good"),
        {"kind": "note", "text": "Weights are included.", "tone": "plain", "level": "normal"},
        table(
            "Angles",
            [
                column("body", ["crank", "coupler", "rocker"]),
                numbers("equilibrium", "deg", [93.7256629, 24.0814789, 103.3686445], 7),
            ],
        ),
        table(
            "Springs, tension positive",
            [
                column("name", ["holder"]),
                numbers("length", "mm", [150.352]),
                numbers("force", "N", [251.759]),
                column("", ["in tension"], tones=["faint"]),
            ],
        ),
        force_table(),
        {
            "kind": "section",
            "title": "Free-body check",
            "level": "normal",
            "items": [
                fact("largest residual", "2.1e-13 N at joint C", "good"),
                fact("method", "sums over bodies cut free", level="verbose"),
                {
                    "kind": "list",
                    "title": "Assumptions",
                    "level": "normal",
                    "items": ["rigid bodies", "no friction in pins"],
                },
            ],
        },
        fact("evaluations", "14", level="verbose"),
        fact("time", "13.6 µs", "faint", "verbose"),
        table(
            "Iterations",
            [numbers("step", "", [1.0, 2.0, 3.0], 0), numbers("residual", "N", [12.5, 0.031, 2e-9], 9)],
            level="verbose",
        ),
    ]
    return document(
        "solve",
        "My four-bar",
        {"text": "In equilibrium, proved: stable.", "tone": "good"},
        [{"kind": "drawing", "title": "", "drawing": still, "play": None, "charts": None}],
        report,
    )


def folding_path(count):
    """A load path with two folds: load over crank angle."""
    angles = [20 + 120 * i / (count - 1) for i in range(count)]
    loads = [37 * math.sin((q - 20) / 38) + 0.16 * (q - 20) for q in angles]
    return loads, angles


def path():
    pool, frames, count = Pool(), [], 200
    loads, angles = folding_path(count)
    bars = [FourBar(math.radians(q)) for q in angles]
    for bar in bars:
        canvas = Canvas(pool)
        bar.draw(canvas)
        frames.append(canvas)
    place = lambda of: [c for bar in bars for c in rounded(*bar.px(of(bar)))]
    captions = [f"load.P = {x:.2f} N, {'unstable' if 60 < k < 110 else 'stable'}" for k, x in enumerate(loads)]
    moved = drawing(
        frames,
        pool,
        900,
        560,
        "Four-bar along its load path",
        captions=captions,
        tones=["bad" if 60 < k < 110 else "good" for k in range(count)],
        confirmed=[not 150 < k < 160 for k in range(count)],
    )
    play = {
        "label": "load.P",
        "unit": "N",
        "values": loads,
        "seconds": 8.0,
        "rest": 20,
        "marks": [
            {"frame": 60, "label": "1", "caption": f"fold at load.P = {loads[60]:.2f} N"},
            {"frame": 110, "label": "2", "caption": f"fold at load.P = {loads[110]:.2f} N"},
            {"frame": 113, "label": "3", "caption": "stop becomes active"},
        ],
        "snaps": [{"first": 61, "last": 85, "caption": "snaps to crank = 71.3 deg"}],
        "points": [
            {"name": "coupler.P", "at": place(lambda bar: bar.p), "traced": True},
            {"name": "coupler.C", "at": place(lambda bar: bar.c), "traced": False},
            {"name": "crank.B", "at": place(lambda bar: bar.b), "traced": False},
        ]
        + [
            {
                "name": f"rocker.point_{i}",
                "at": place(lambda bar: (bar.c[0] * i / 14 + 0.3 * (1 - i / 14), bar.c[1] * i / 14)),
                "traced": False,
            }
            for i in range(1, 13)
        ],
    }
    gap = [None if 60 < k < 110 else q for k, q in enumerate(angles)]
    unstable = [q if 60 <= k <= 110 else None for k, q in enumerate(angles)]
    charts = {
        "columns": 1,
        "panels": [
            {
                "title": "Load path",
                "x_label": "load.P (N)",
                "y_label": "crank (deg)",
                "log_x": False,
                "log_y": False,
                "x_falls": False,
                "tall": True,
                "curves": [
                    {"name": "stable", "x": loads, "y": gap, "style": "line", "colour": "curve-1"},
                    {"name": "unstable", "x": loads, "y": unstable, "style": "dashed", "colour": "curve-4"},
                ],
                "levels": [{"y": 130, "name": "limit of the handle"}],
                "bands": [{"low": 25, "high": 45, "name": "working range"}],
                "marks": [
                    {"x": loads[60], "y": angles[60], "label": "1"},
                    {"x": loads[110], "y": angles[110], "label": "2"},
                ],
                "arrows": [{"from": [loads[60], angles[60]], "to": [loads[60], angles[160]]}],
                "cursor": {"x": loads, "y": angles},
            },
            {
                "title": "",
                "x_label": "crank (deg)",
                "y_label": "force in joint A (N)",
                "log_x": False,
                "log_y": False,
                "x_falls": True,
                "tall": False,
                "curves": [
                    {
                        "name": "",
                        "x": angles,
                        "y": [80 + x * x / 20 for x in loads],
                        "style": "line",
                        "colour": "curve-5",
                    }
                ],
                "levels": [],
                "bands": [],
                "marks": [],
                "arrows": [],
                "cursor": {"x": angles, "y": []},
            },
        ],
    }
    events = table(
        "Events",
        [
            column("", ["1", "2", "3"]),
            numbers("load.P", "N", [loads[60], loads[110], loads[113]]),
            column("event", ["fold", "fold", "stop becomes active"]),
        ],
    )
    return document(
        "path",
        "Four-bar along its load",
        {"text": "The path is confirmed, except 9 positions.", "tone": "doubtful"},
        [{"kind": "drawing", "title": "Load path", "drawing": moved, "play": play, "charts": charts}],
        [fact("positions", "200, of which 191 are confirmed"), events, force_table()],
        warnings=[
            {
                "text": "9 positions between 150 and 160 are not confirmed: the step is too long for the proof.",
                "tone": "doubtful",
            },
            {"text": "A stop becomes active at 113; beyond it the path is not unique.", "tone": "bad"},
        ],
    )


def cards():
    pool, frames = Pool(), []
    for i in range(12):
        canvas = Canvas(pool)
        FourBar(math.radians(20 + 28 * i), 600, (130, 240)).draw(canvas, forces=False, names=False)
        canvas.text("heading", (14, 22), str(i + 1), bold=True, size=15)
        frames.append(canvas)
    shown = drawing(
        frames,
        pool,
        420,
        320,
        "Equilibria of the four-bar",
        captions=[f"{i + 1}: {'stable' if i % 3 else 'unstable'}, energy {31.2 + 4.7 * i:.1f} N mm" for i in range(12)],
        tones=["good" if i % 3 else "bad" for i in range(12)],
        confirmed=[i != 7 for i in range(12)],
    )
    listed = table(
        "Equilibria",
        [
            numbers("no.", "", [float(i + 1) for i in range(12)], 0),
            numbers("energy", "N mm", [31.2 + 4.7 * i for i in range(12)], 1),
            column(
                "stability",
                ["stable" if i % 3 else "unstable" for i in range(12)],
                tones=["good" if i % 3 else "bad" for i in range(12)],
            ),
        ],
    )
    return document(
        "equilibria",
        "Where the four-bar can rest",
        {"text": "12 equilibria; all are found.", "tone": "good"},
        [{"kind": "cards", "title": "Equilibria", "drawing": shown}],
        [listed],
    )


def panel(x_label, y_label, curves, **more):
    return {
        "title": "",
        "x_label": x_label,
        "y_label": y_label,
        "log_x": False,
        "log_y": False,
        "x_falls": False,
        "tall": False,
        "curves": curves,
        "levels": [],
        "bands": [],
        "marks": [],
        "arrows": [],
        "cursor": None,
    } | more


def identify():
    random.seed(7)
    times = [i / 250 for i in range(2000)]
    panels = []
    for k in range(4):
        model = [40 * math.exp(-0.3 * t) * math.cos(2 * (k + 1) * t) for t in times]
        measured = [None if 900 < i < 960 else y + random.gauss(0, 1.5) for i, y in enumerate(model)]
        rest = [None if m is None else m - y for m, y in zip(measured, model)]
        panels.append(
            panel(
                "",
                f"angle {k + 1} (deg)",
                [
                    {"name": "measured", "x": times, "y": measured, "style": "points", "colour": "curve-6"},
                    {"name": "model", "x": times, "y": model, "style": "line", "colour": "curve-4"},
                ],
            )
        )
        panels.append(
            panel(
                "time (s)" if k == 3 else "",
                f"residual {k + 1} (deg)",
                [{"name": "", "x": times, "y": rest, "style": "points", "colour": "curve-1"}],
                bands=[{"low": -3, "high": 3, "name": "95 %"}],
                levels=[{"y": 0.05, "name": "mean"}],
            )
        )
    tolerances = [10**-e for e in range(2, 15)]
    styles = ["marked", "dashed", "dotted", "marked", "crosses"]
    work = {
        "columns": 1,
        "panels": [
            panel(
                "time (s)",
                "error",
                [
                    {
                        "name": name,
                        "x": [1e-5 * (1 + k) * (1 + 0.5 * i) ** (1 + 0.3 * k) for i in range(13)],
                        "y": [t * 10 ** (0.3 * k) for t in tolerances],
                        "style": styles[k],
                        "colour": f"curve-{k + 1}",
                    }
                    for k, name in enumerate(
                        ["virtual-work", "energy", "augmented Lagrangian", "dynamic relaxation", "failed"]
                    )
                ],
                log_x=True,
                log_y=True,
                tall=True,
                title="Work and precision",
                levels=[{"y": 1e-12, "name": "tolerance asked for"}],
            )
        ],
    }
    modes = {
        "columns": 2,
        "panels": [
            panel(
                "frequency (Hz)",
                "gain",
                [
                    {
                        "name": f"mode {k + 1}",
                        "x": [0.5 * 1.05**i for i in range(90)],
                        "y": [1 / (0.02 + abs(1 - (0.5 * 1.05**i / (3 + 4 * k)) ** 2)) for i in range(90)],
                        "style": "line",
                        "colour": f"curve-{k + 1}",
                    }
                    for k in range(4)
                ],
                log_y=True,
                log_x=True,
            ),
            panel(
                "stiffness (N/m)",
                "probability density",
                [
                    {
                        "name": "posterior",
                        "x": [1.2e7 + 1e4 * i for i in range(100)],
                        "y": [4e-7 * math.exp(-(((i - 50) / 15) ** 2)) for i in range(100)],
                        "style": "line",
                        "colour": "curve-7",
                    }
                ],
            ),
        ],
    }
    names = [
        f"{kind}.{part}"
        for kind in ("mass", "inertia", "stiffness", "damping")
        for part in ("crank", "coupler", "rocker")
    ]
    correlations = table(
        "Correlations of the estimates",
        [column("", names)]
        + [
            numbers(name, "", [round(1.0 if i == j else math.sin(3 * i + 5 * j) * 0.9, 3) for j in range(12)])
            for i, name in enumerate(names)
        ],
        ["Where two are near 1 or −1, the data cannot tell them apart."],
    )
    estimates = table(
        "Estimates",
        [
            column("unknown", names),
            numbers("value", "SI", [0.3 + 0.11 * i for i in range(12)], 4),
            numbers("standard error", "SI", [None if i == 5 else 0.001 * (i + 1) for i in range(12)], 4),
            column(
                "",
                ["not identifiable" if i == 5 else "" for i in range(12)],
                tones=["bad" if i == 5 else "plain" for i in range(12)],
            ),
        ],
    )
    samples = table(
        "Samples",
        [
            numbers("sample", "", [float(i + 1) for i in range(400)], 0),
            column("run", [f"run {i % 7 + 1}" for i in range(400)]),
            numbers("time", "s", [i / 50 for i in range(400)]),
            numbers("angle", "deg", [40 * math.cos(i / 9) for i in range(400)]),
            numbers("residual", "deg", [random.gauss(0, 1) for _ in range(400)]),
        ],
    )
    return document(
        "identify",
        "Masses of the four-bar from its motion",
        {"text": "11 of 12 unknowns are identified; inertia.rocker is not.", "tone": "doubtful"},
        [
            {"kind": "charts", "title": "Measured and modelled angles", "charts": {"columns": 1, "panels": panels}},
            {"kind": "charts", "title": "Methods", "charts": work},
            {"kind": "charts", "title": "Response", "charts": modes},
        ],
        [fact("runs", "7"), fact("samples", "2000 in each"), estimates, correlations, samples],
    )


def hostile():
    bad = "</script><img src=x onerror=alert(1)><!--<script>"
    pool = Pool()
    canvas = Canvas(pool)
    FourBar(1.0).draw(canvas)
    canvas.line("bodies", bad, (50, 50), (200, 80), stroke="no-such-colour", width=6)
    canvas.text("labels", (60, 120), bad)
    canvas.text("labels", (60, 140), "{{scripts}} ${1} \u202eright to left\u202c \u0000 ]]> " + "long" * 30)
    frames = [canvas, canvas, canvas]
    shown = drawing(frames, pool, 900, 560, bad, captions=[bad] * 3, tones=["bad"] * 3)
    play = {
        "label": bad,
        "unit": bad,
        "values": [0, 1, 2],
        "seconds": 1,
        "marks": [{"frame": 1, "label": bad, "caption": bad}],
        "snaps": [],
        "rest": 0,
        "points": [{"name": "__proto__", "at": [0, 0, 50, 50, 100, 0], "traced": True}],
    }
    curve = {"name": bad, "x": [0, 1, 2], "y": [1, None, 4], "style": "__proto__", "colour": "red;}body{display:none"}
    charts = {"columns": 1, "panels": [panel(bad, "<b>y</b>", [curve], title=bad, cursor={"x": [0, 1, 2], "y": []})]}
    made = document(
        "solve",
        bad,
        {"text": bad, "tone": "__proto__"},
        [{"kind": "drawing", "title": bad, "drawing": shown, "play": play, "charts": charts}],
        [
            fact(bad, bad, bad),
            {"kind": "list", "title": bad, "items": [bad], "level": "normal"},
            table(bad, [column(bad, [bad, "=1+1"]), numbers("constructor", bad, [1.0, None])], [bad]),
        ],
        source=bad,
        line=f"poise solve '{bad}'",
        warnings=[{"text": bad, "tone": bad}],
    )
    made["palette"] = PALETTE | {"evil;}body{display:none}": ["#000000", "#000000"], "odd": ["url(x)", "red"]}
    return made


def edges():
    """Empty, constant, very large and very small."""
    pool = Pool()
    two = [Canvas(pool), Canvas(pool)]
    for i, canvas in enumerate(two):
        FourBar(0.8 + i).draw(canvas, forces=False)
    moved = drawing(two, pool, 900, 560, "Two frames")
    play = {
        "label": "",
        "unit": "",
        "values": [0, 0],
        "seconds": 0,
        "snaps": [{"first": 0, "last": 1, "caption": "snaps at once"}],
        "marks": [{"frame": 1, "label": "1", "caption": "first"}, {"frame": 1, "label": "2", "caption": "second"}],
        "rest": 9,
        "points": [],
    }
    line = lambda x, y, style="line": {"name": style, "x": x, "y": y, "style": style, "colour": "curve-1"}
    panels = [
        panel("x (m)", "no curves", []),
        panel("x (m)", "no points", [line([], [])]),
        panel("x (m)", "gaps only (N)", [line([None, 1], [2, None])]),
        panel("x (m)", "constant (N)", [line([1, 2, 3], [5, 5, 5])]),
        panel("x (m)", "one point (N)", [line([3], [0], "marked")]),
        panel("x (m)", "logarithm of what is not positive", [line([-1, 0, 1], [0, -3, 0])], log_x=True, log_y=True),
        panel(
            "x (m)",
            "less than a decade, falling",
            [line([2, 3, 4.5], [2.1, 3, 4.7])],
            log_x=True,
            log_y=True,
            x_falls=True,
        ),
        panel("x (m)", "large (N)", [line([1e200, 3e200], [-1e300, 1e300])]),
        panel("x (m)", "small (N)", [line([1e-14, 3e-14], [1e-12, 1.5e-12])]),
        panel("x (m)", "close to a large number (m)", [line([100000.001, 100000.002], [1.00001, 1.00002])]),
    ]
    empty = [
        table("No rows", [column("name", []), numbers("F", "N", [])]),
        table("No columns", []),
        {"kind": "section", "title": "", "level": "normal", "items": []},
        {"kind": "section", "title": "Only details", "level": "normal", "items": [fact("a", "b", level="verbose")]},
    ]
    return document(
        "motion",
        "Edges",
        {"text": "", "tone": "plain"},
        [
            {"kind": "drawing", "title": "Two frames", "drawing": moved, "play": play, "charts": None},
            {"kind": "charts", "title": "Charts", "charts": {"columns": 3, "panels": panels}},
            {"kind": "cards", "title": "", "drawing": moved},
        ],
        empty,
        result={},
    )


def bare():
    return document(
        "check",
        "",
        {"text": "Not found: the loop of bodies cannot be closed.", "tone": "bad"},
        [],
        [],
        source="",
        result=None,
    )


def not_confirmed():
    pool = Pool()
    canvas = Canvas(pool)
    FourBar(0.7).draw(canvas)
    still = drawing(
        [canvas],
        pool,
        900,
        560,
        "Four-bar, not confirmed",
        captions=["checked, not proved"],
        tones=["doubtful"],
        confirmed=[False],
    )
    return document(
        "solve",
        "Four-bar",
        {"text": "Checked, not proved.", "tone": "doubtful"},
        [{"kind": "drawing", "title": "", "drawing": still, "play": None, "charts": None}],
        [],
    )


def large():
    """300 shapes that all change in every frame: for measuring."""
    pool, frames = Pool(), []
    for k in range(100):
        canvas = Canvas(pool)
        for i in range(300):
            a = (30 + 28 * (i % 30) + 5 * math.sin(k / 9 + i), 40 + 50 * (i // 30))
            canvas.many(
                "polygon",
                "bodies",
                f"body {i}",
                [a, (a[0] + 20, a[1]), (a[0] + 10 + k / 10, a[1] + 22)],
                fill=f"body-{i % 9 + 1}",
                stroke="dark",
            )
        frames.append(canvas)
    shown = drawing(frames, pool, 900, 560, "300 moving triangles")
    play = {
        "label": "time",
        "unit": "s",
        "values": [k / 20 for k in range(100)],
        "seconds": 5,
        "marks": [],
        "snaps": [],
        "rest": 0,
        "points": [],
    }
    return document(
        "motion",
        "300 shapes",
        {"text": "Computed.", "tone": "plain"},
        [{"kind": "drawing", "title": "", "drawing": shown, "play": play, "charts": None}],
        [],
    )


FIXTURES = [solve, path, cards, identify, hostile, edges, bare, not_confirmed, large]

if __name__ == "__main__":
    folder = pathlib.Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    for fixture in FIXTURES:
        text = json.dumps(fixture(), ensure_ascii=False)
        (folder / f"{fixture.__name__}.json").write_text(text, encoding="utf-8")
        (folder / f"{fixture.__name__}.html").write_text(page(text), encoding="utf-8")
    (folder / "broken.html").write_text(page('{"poise": "0.1.0", '), encoding="utf-8")
