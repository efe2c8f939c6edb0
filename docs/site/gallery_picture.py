"""Small pictures of the mechanisms that reports of ``--html`` play (docs/json.md, Drawing)."""

from __future__ import annotations

import html
import math
from typing import Any, Iterator

#: What a small picture leaves out.
LEFT_OUT = {"labels", "heading", "legend", "scale", "gravity", "reactions", "drives", "other-positions", "paths"}
#: What is shown faintly in other frames.
MOVING = {"bodies", "springs-and-dampers", "centres-of-mass"}
MARGIN = 8.0  # px
USUAL_WIDTH = 330.0  # px of a drawing whose lines are as wide as in the report

Shape = list[Any]
Box = tuple[float, float, float, float]


def states(drawing: dict[str, Any]) -> Iterator[list[int]]:
    """The shape in every slot, frame by frame; -1 for none."""
    now = list(drawing["frames"][0])
    yield now
    for changes in drawing["frames"][1:]:
        now = list(now)
        for slot, shape in zip(changes[::2], changes[1::2]):
            now[slot] = shape
        yield now


def corners(shape: Shape) -> list[tuple[float, float]]:
    """Points between which a shape lies."""
    kind = shape[0]
    if kind in ("polyline", "polygon"):
        return list(zip(shape[2][::2], shape[2][1::2]))
    if kind == "line":
        return [(shape[2], shape[3]), (shape[4], shape[5])]
    x, y, r = shape[2:5]
    return [(x - r, y - r), (x + r, y + r)]


def arc_path(x: float, y: float, r: float, start: float, end: float) -> str:
    """As quarter circles: one arc of SVG cannot be a full turn."""
    pieces = max(1, math.ceil(abs(end - start) / (math.pi / 2)))
    angles = [start + (end - start) * i / pieces for i in range(pieces + 1)]
    points = [f"{x + r * math.cos(a):.1f} {y - r * math.sin(a):.1f}" for a in angles]
    sweep = 0 if end > start else 1
    return f"M{points[0]}" + "".join(f"A{r} {r} 0 0 {sweep} {point}" for point in points[1:])


def svg_of(shape: Shape, style: dict[str, Any], colours: dict[str, list[str]], bolder: float) -> str:
    """A shape as an element of SVG, with lines so many times as wide."""
    def colour(name: str) -> str:
        return colours[name][0] if name in colours else "none"

    paint = f'fill="{colour(style["fill"])}" stroke="{colour(style["stroke"])}" '
    paint += f' stroke-width="{style["width"] * bolder:.1f}"'
    if style["dash"]:
        paint += f' stroke-dasharray="{style["dash"]}"'
    if style["opacity"] != 1:
        paint += f' opacity="{style["opacity"]}"'
    kind = shape[0]
    if kind == "line":
        place = 'x1="{}" y1="{}" x2="{}" y2="{}"'.format(*shape[2:])
    elif kind in ("polyline", "polygon"):
        place = 'points="' + " ".join(f"{x:.1f},{y:.1f}" for x, y in corners(shape)) + '"'
    elif kind == "circle":
        place = 'cx="{}" cy="{}" r="{}"'.format(*shape[2:])
    else:
        kind, place = "path", f'd="{arc_path(*shape[2:])}"'
    return f"<{kind} {place} {paint}/>"


def picture(drawing: dict[str, Any], colours: dict[str, list[str]], rest: int, ghosts: list[int], title: str) -> str:
    """The frame `rest` of a drawing, with others behind it."""
    wanted = {rest, *ghosts}
    frames = {k: state for k, state in enumerate(states(drawing)) if k in wanted}

    def shown(k: int) -> list[Shape]:
        shapes = [(layer, drawing["shapes"][number])
                  for (layer, _), number in zip(drawing["slots"], frames[k]) if number >= 0]
        return [shape for layer, shape in shapes
                if shape[0] != "text" and (layer not in LEFT_OUT if k == rest else layer in MOVING)]

    boxed = [corner for k in wanted for shape in shown(k) for corner in corners(shape)]
    left, right = min(x for x, _ in boxed) - MARGIN, max(x for x, _ in boxed) + MARGIN
    top, bottom = min(y for _, y in boxed) - MARGIN, max(y for _, y in boxed) + MARGIN
    bolder = min(2.5, max(1.0, (right - left) / USUAL_WIDTH))

    def drawn(k: int) -> str:
        return "".join(svg_of(shape, drawing["styles"][shape[1]], colours, bolder) for shape in shown(k))

    faint = "".join(f'<g opacity="0.18">{drawn(k)}</g>' for k in ghosts)
    strong = drawn(rest)
    return (f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="{left:.1f} {top:.1f} {right - left:.1f} '
            f'{bottom - top:.1f}" stroke-linecap="round" stroke-linejoin="round" role="img">'
            f"<title>{html.escape(title)}</title>{faint}{strong}</svg>\n")


def figure_that_plays(document: dict[str, Any]) -> dict[str, Any] | None:
    """The first figure of a page in which a player moves a mechanism, else the first that has cards to go through."""
    cards = None
    for figure in document["figures"]:
        if figure["kind"] == "cards":
            cards = cards or figure
        elif figure["kind"] == "drawing" and figure["play"]:
            layers = [layer for layer, _ in figure["drawing"]["slots"]]
            moved = {layers[slot] for changes in figure["drawing"]["frames"][1:] for slot in changes[::2]}
            if moved & {*MOVING, "joints", "stops", "diagrams"}:
                return dict(figure)
    return cards


def picture_of(document: dict[str, Any]) -> str:
    """The picture of a page in which something plays, of how it begins, with a third and two thirds of its way."""
    figure = figure_that_plays(document)
    assert figure is not None
    count = len(figure["drawing"]["frames"])
    rest = (figure.get("play") or {}).get("rest", 0)
    ghosts = [] if figure["kind"] == "cards" else sorted({count // 3, 2 * count // 3, count - 1} - {rest})
    return picture(figure["drawing"], document["palette"], rest, ghosts, document["title"])
