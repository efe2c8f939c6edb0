"""One visual language for the drawings of the reference pages: parts, dimensions, angles, forces and labels as SVG.

Points are complex numbers in the units of a panel, y upwards. Keys of files stand in backticks: "`radius` of a".
"""

from __future__ import annotations

import cmath
import math
import re
from collections.abc import Sequence
from html import escape

WIDTH = 440
FONT = 13
# Classes of paths and texts, a letter each: the files stay small.
STYLE = """
.p{fill:#fff}
.a{fill:#dfe6ee}.e{fill:#f3e4c8}.a,.e,.o{stroke:#2b343c;stroke-width:1.5}.o,.c,.x,.w,.d,.s,.f,.v{fill:none}
.q{fill:#fff;stroke:#2b343c;stroke-width:1.5}
.m{fill:#2b343c;stroke:none}
.g{fill:none;stroke:#68717a;stroke-width:1}
.c{stroke:#68717a;stroke-width:1;stroke-dasharray:5 3}
.x{stroke:#a9b0b7;stroke-width:1}
.w{stroke:#0072b2;stroke-width:2.4}
.v{stroke:#2f7d4f;stroke-width:1.8}
.d{stroke:#1f5fb4;stroke-width:1.1}.dh{fill:#1f5fb4}
.s{stroke:#a3247f;stroke-width:1.8}.sh{fill:#a3247f}
.f{stroke:#c8202b;stroke-width:2}.fh{fill:#c8202b}
text{fill:#222b33;stroke:#fff;stroke-width:3px;paint-order:stroke;stroke-linejoin:round}
.ha{stroke:#dfe6ee}.he{stroke:#f3e4c8}
.k{font-family:ui-monospace,Menlo,Consolas,'DejaVu Sans Mono',monospace;font-size:12px;font-weight:600}
.n{fill:#68717a}
@media(prefers-color-scheme:dark){.p{fill:#14181d}.a{fill:#34414e}.e{fill:#57492c}.a,.e,.o,.q{stroke:#d5dbe0}
.q{fill:#14181d}.m{fill:#d5dbe0}.g,.c{stroke:#9aa5ae}.x{stroke:#5e6870}.w{stroke:#56b4e9}.v{stroke:#62c68b}
.d{stroke:#74aefc}.dh{fill:#74aefc}.s{stroke:#f08ad0}.sh{fill:#f08ad0}.f{stroke:#ff7a80}.fh{fill:#ff7a80}
text{fill:#e3e8ec;stroke:#14181d}.ha{stroke:#34414e}.he{stroke:#57492c}.n{fill:#9aa5ae}}
"""


def turned(angle: float) -> complex:
    """The direction at an angle in degrees."""
    return cmath.exp(1j * math.radians(angle))


def number(value: float) -> str:
    return f"{round(value, 1) + 0.0:g}"


def width_of(text: str) -> float:
    """The width of a text in pixels, as most fonts have it."""
    return 7.3 * len(re.sub("[`_]", "", text))


def is_inside(p: complex, corners: Sequence[complex]) -> bool:
    """Whether a place is in a polygon: a ray to the right crosses its sides an odd number of times."""
    crossings = 0
    for a, b in zip(corners, [*corners[1:], corners[0]]):
        if (a.imag > p.imag) != (b.imag > p.imag):
            crossings += (p.imag - a.imag) * (b - a).real / (b - a).imag + a.real > p.real
    return crossings % 2 == 1


def spans(text: str) -> str:
    """Keys in backticks in monospace, subscripts behind an underscore: "`ratio` = r_a : r_b"."""
    out = []
    for part in re.split(r"(`[^`]+`)", text):
        if part.startswith("`"):
            out.append(f'<tspan class="k">{escape(part[1:-1])}</tspan>')
        else:
            sub = r'<tspan dy="3" font-size="10">\1</tspan><tspan dy="-3">&#8203;</tspan>'
            out.append(re.sub(r"_(\w)", sub, escape(part)))
    return "".join(out)


class Drawing:
    """A figure of a page, WIDTH wide."""

    def __init__(self, title: str, height: float) -> None:
        self.title = title
        self.height = height
        self.parts: list[str] = []
        #: What has been filled, in pixels, each with its style.
        self.filled: list[tuple[list[complex], str]] = []

    def panel(self, origin: complex, scale: float = 1.0) -> Panel:
        """A panel with its origin at a place from the upper left corner, x + iy with y downwards."""
        return Panel(self, origin, scale)

    def svg(self) -> str:
        width = WIDTH * 1.3
        return (
            f'<svg xmlns="http://www.w3.org/2000/svg" width="{number(width)}" height="{number(self.height * 1.3)}" '
            f'viewBox="0 0 {WIDTH} {number(self.height)}" font-size="{FONT}" '
            "font-family=\"system-ui,'Segoe UI',Helvetica,Arial,'DejaVu Sans',sans-serif\">\n"
            f"<title>{escape(self.title)}</title>\n<style>{STYLE}</style>\n"
            f'<rect class="p" width="{WIDTH}" height="{number(self.height)}" rx="6"/>\n'
            + "\n".join(self.parts) + "\n</svg>\n"
        )


class Panel:
    """A part of a drawing with its own origin and scale."""

    def __init__(self, drawing: Drawing, origin: complex, scale: float) -> None:
        self.drawing = drawing
        self.origin = origin
        self.scale = scale

    def at(self, p: complex) -> complex:
        return self.origin + self.scale * complex(p).conjugate()

    def _place(self, p: complex) -> str:
        q = self.at(p)
        return f"{number(q.real)} {number(q.imag)}"

    def _add(self, part: str) -> None:
        self.drawing.parts.append(part)

    def _fill(self, corners: Sequence[complex], style: str) -> None:
        if style in "aeq":
            self.drawing.filled.append(([self.at(p) for p in corners], style))

    # Lines and areas.

    def line(self, *points: complex, style: str = "o", closed: bool = False) -> None:
        path = "L".join(self._place(p) for p in points) + ("Z" if closed else "")
        if closed:
            self._fill(points, style)
        self._add(f'<path class="{style}" d="M{path}"/>')

    def area(self, points: Sequence[complex], style: str = "a") -> None:
        self.line(*points, style=style, closed=True)

    def circle(self, center: complex, radius: float, style: str = "o") -> None:
        c = self.at(center)
        self._fill([center + radius * turned(angle) for angle in range(0, 360, 10)], style)
        self._add(f'<circle class="{style}" cx="{number(c.real)}" cy="{number(c.imag)}" '
                  f'r="{number(radius * self.scale)}"/>')

    def arc(self, center: complex, radius: float, begin: float, end: float, style: str = "o") -> None:
        """From one angle to another, in degrees; counter-clockwise where the end is greater."""
        first, last = center + radius * turned(begin), center + radius * turned(end)
        r = number(radius * self.scale)
        large, sweep = int(abs(end - begin) > 180), int(end < begin)
        self._add(f'<path class="{style}" d="M{self._place(first)}A{r} {r} 0 {large} {sweep} {self._place(last)}"/>')

    def link(self, a: complex, b: complex, half: float = 7, style: str = "a") -> None:
        """A bar with round ends, half as wide in pixels as said."""
        n = 1j * (b - a) / abs(b - a) * half / self.scale
        r = number(half)
        self._fill((a + n, a - n, b - n, b + n), style)
        path = [self._place(p) for p in (a + n, a - n, b - n, b + n)]
        arc = f"A{r} {r} 0 0 0 "
        self._add(f'<path class="{style}" d="M{path[0]}{arc}{path[1]}L{path[2]}{arc}{path[3]}Z"/>')

    def block(self, center: complex, width: float, height: float, angle: float = 0, style: str = "a") -> None:
        t = turned(angle)
        self.area([center + t * complex(x * width / 2, y * height / 2)
                   for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))], style)

    # Joints and supports; sizes in pixels.

    def pin(self, p: complex, radius: float = 4) -> None:
        self.circle(p, radius / self.scale, "q")

    def dot(self, p: complex, radius: float = 3) -> None:
        self.circle(p, radius / self.scale, "m")

    def ground(self, a: complex, b: complex) -> None:
        """A line with hatches on its right."""
        t = (b - a) / abs(b - a)
        self.line(a, b)
        count = max(2, round(abs(b - a) * self.scale / 8))
        down = (-1j - 0.7) * t * 7 / self.scale
        marks = [f"M{self._place(p)}L{self._place(p + down)}" for p in
                 (a + (k + 0.8) / count * (b - a) for k in range(count))]
        self._add(f'<path class="g" d="{"".join(marks)}"/>')

    def support(self, p: complex, angle: float = 0) -> None:
        """A pin on the ground."""
        t = turned(angle) / self.scale
        self.line(p, p + t * (-9 - 15j), p + t * (9 - 15j), closed=True, style="a")
        self.ground(p + t * (-14 - 15j), p + t * (14 - 15j))
        self.pin(p)

    def frame(self, p: complex, angle: float = 0, size: float = 26, names: tuple[str, str] = ("x", "y")) -> None:
        """Axes of a frame."""
        t = turned(angle) / self.scale
        self.arrow(p, p + size * t, "g", "m", 6)
        self.arrow(p, p + 1j * size * t, "g", "m", 6)
        self.text(p + t * (size + 8), names[0], "n", down=4)
        self.text(p + 1j * t * (size + 8), names[1], "n", down=4)

    def spring(self, a: complex, b: complex, coils: int = 6, half: float = 6, style: str = "v") -> None:
        t = (b - a) / abs(b - a)
        end = 0.16 * abs(b - a)
        inner = abs(b - a) - 2 * end
        points = [a, a + end * t]
        for k in range(2 * coils):
            points.append(a + t * (end + (k + 0.5) / (2 * coils) * inner) + 1j * t * (half / self.scale) * (-1) ** k)
        self.line(*points, b - end * t, b, style=style)

    # Arrows, dimensions, text.

    def _head(self, tip: complex, direction: complex, style: str, size: float) -> None:
        t = direction / abs(direction) * size / self.scale
        self.area([tip, tip - t + 0.36j * t, tip - t - 0.36j * t], style)

    def arrow(self, a: complex, b: complex, style: str = "f", head: str = "", size: float = 8,
              both: bool = False) -> None:
        t = (b - a) / abs(b - a) * 0.6 * size / self.scale
        self.line(a + t if both else a, b - t, style=style)
        self._head(b, b - a, head or style + "h", size)
        if both:
            self._head(a, a - b, head or style + "h", size)

    def turn(self, center: complex, radius: float, begin: float, end: float, style: str = "s",
             both: bool = False) -> None:
        """An arc with a head at its end, from one angle to another, in degrees."""
        way = 1 if end > begin else -1
        lead = way * math.degrees(5 / (radius * self.scale))
        self.arc(center, radius, begin + (lead if both else 0), end - lead, style)
        self._head(center + radius * turned(end), 1j * way * turned(end - 0.7 * lead), style + "h", 8)
        if both:
            self._head(center + radius * turned(begin), -1j * way * turned(begin + 0.7 * lead), style + "h", 8)

    def dimension(self, a: complex, b: complex, text: str, away: float = 0, where: float = 0.5,
                  one: bool = False, aside: float = 0) -> None:
        """Between two points, `away` pixels to the left of the way from a to b; `one`: with one head, a signed one.

        The line leaves room for its text, where there is room.
        """
        t = (b - a) / abs(b - a)
        n = 1j * t * away / self.scale
        over = 1j * t * math.copysign(4, away) / self.scale
        if away:
            self.line(a, a + n + over, style="x")
            self.line(b, b + n + over, style="x")
        first, last = a + n, b + n
        middle = first + where * (b - a)
        way = min(0.5 * width_of(text) / max(abs(t.real), 1e-9), 9 / max(abs(t.imag), 1e-9)) + 3
        room = min(abs(middle - first) - (0 if one else 7 / self.scale), abs(last - middle) - 7 / self.scale)
        if text and not aside and 0 < where < 1 and way / self.scale < room:
            self.arrow(middle + way * t / self.scale, last, "d", size=7)
            if one:
                self.line(first, middle - way * t / self.scale, style="d")
            else:
                self.arrow(middle - way * t / self.scale, first, "d", size=7)
        else:
            self.arrow(first, last, "d", size=7, both=not one)
        if one:
            self.line(a + n + 4j * t / self.scale, a + n - 4j * t / self.scale, style="d")
        self.text(middle + 1j * t * aside / self.scale, text, down=4)

    def text(self, p: complex, text: str, style: str = "", anchor: str = "middle", right: float = 0,
             down: float = 0) -> None:
        q = self.at(p) + complex(right, down)
        classes = " ".join(filter(None, [style, self._halo(q, text, anchor)]))
        look = f' class="{classes}"' if classes else ""
        side = f' text-anchor="{anchor}"' if anchor != "start" else ""
        self._add(f'<text x="{number(q.real)}" y="{number(q.imag)}"{side}{look}>{spans(text)}</text>')

    def _halo(self, q: complex, text: str, anchor: str) -> str:
        """The class of the halo that a text has: the colour of what the whole of it stands on."""
        begin = {"start": 0.0, "middle": 0.5, "end": 1.0}[anchor] * -width_of(text)
        ends = [q + begin - 4j, q + begin + width_of(text) - 4j]
        for corners, style in reversed(self.drawing.filled):
            inside = [is_inside(end, corners) for end in ends]
            if any(inside):
                return f"h{style}" if all(inside) and style in "ae" else ""
        return ""

    def texts(self, p: complex, lines: Sequence[str], style: str = "", anchor: str = "start", step: float = 17) -> None:
        for k, line in enumerate(lines):
            self.text(p, line, style, anchor, down=k * step)

    def leader(self, tip: complex, at: complex, text: str, anchor: str = "start") -> None:
        """A thin line from a label to what it names."""
        self.line(tip, at, style="g")
        right = 4 if anchor == "start" else -4 if anchor == "end" else 0
        # A label in the middle stands behind the end of the line.
        down = 4 if right else -4 if complex(tip).imag < complex(at).imag else 13
        self.text(at, text, anchor=anchor, right=right, down=down)
