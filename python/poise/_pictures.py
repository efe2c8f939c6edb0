"""What notebooks show of a result, and charts of it in matplotlib."""

from __future__ import annotations

import base64
import html
from typing import TYPE_CHECKING, Any, Iterator, Mapping, Sequence

import numpy as np

from . import _poise
from ._tables import Array, checked_name, needed, unknown

if TYPE_CHECKING:
    from ._found import Curve, Fit, Found, Motion, PathPoint, Tolerance

#: How a line is drawn that has this stability.
LINES = {"stable": "-", "unstable": "--"}


# ---- HTML ----


def html_of(found: Found) -> str:
    """The picture of a result, as an image, so that it changes nothing else on the page, and its report with tables."""
    picture = ""
    if found.svg:
        data = base64.b64encode(found.svg.encode()).decode()
        picture = (f'<img src="data:image/svg+xml;base64,{data}" alt="{html.escape(found.verdict)}" '
                   'style="max-width: 100%; background: white">')
    return f"<div>{picture}{report_html(found.markdown)}</div>"


def report_html(markdown: str) -> str:
    """The HTML of a report in Markdown: headings, paragraphs, lists and tables, which is all that reports have."""
    out: list[str] = []
    for block in markdown.strip().split("\n\n"):
        lines = block.split("\n")
        if block.startswith("#"):
            level = len(block) - len(block.lstrip("#"))
            out.append(f"<h{level + 2}>{html.escape(block[level:].strip())}</h{level + 2}>")
        elif block.startswith("|"):
            out.append(table_html([cells_of(line) for line in lines]))
        elif block.startswith("- "):
            out.append("<ul>" + "".join(f"<li>{html.escape(line[2:])}</li>" for line in lines) + "</ul>")
        else:
            out.append(f"<p>{html.escape(block)}</p>")
    return "".join(out)


def cells_of(line: str) -> list[str]:
    """The cells of a row of a table in Markdown."""
    bar = "\0"  # in place of a bar that is part of a cell
    return [cell.strip().replace(bar, "|") for cell in line.replace("\\|", bar).strip().strip("|").split("|")]


def table_html(rows: list[list[str]]) -> str:
    """A table of a head, a row with the alignment of the columns, and the others."""
    head, align = rows[0], ["right" if cell.endswith(":") else "left" for cell in rows[1]]

    def row(cells: list[str], tag: str) -> str:
        shown = (f'<{tag} style="text-align: {side}; padding: 0.1em 0.6em">{html.escape(cell)}</{tag}>'
                 for cell, side in zip(cells, align))
        return f"<tr>{''.join(shown)}</tr>"

    body = "".join(row(cells, "td") for cells in rows[2:])
    return f"<table><thead>{row(head, 'th')}</thead><tbody>{body}</tbody></table>"


# ---- matplotlib ----


def axes(ax: Any) -> Any:
    """The axes given, or new ones. Raises InputError for anything else, ImportError without matplotlib."""
    pyplot = needed("matplotlib.pyplot", "python3-matplotlib", "plot()")
    if ax is None:
        return pyplot.subplots()[1]
    if not isinstance(ax, pyplot.Axes):
        raise _poise.InputError(f"ax: expected axes of matplotlib, found {type(ax).__name__}")
    return ax


def with_unit(name: str, unit: str) -> str:
    """The title of an axis."""
    return f"{name} ({unit})" if unit else name


def numbers_to_draw(name: str, values: Any) -> Array:
    """The values of a column. Raises InputError for words, and for what is no column."""
    if isinstance(values, np.ndarray) and values.dtype.kind == "f":
        return values
    raise _poise.InputError(f"plot: expected the name of numbers, found {name}, which has none")


def lines_of(stability: Array, critical: Array) -> Iterator[tuple[str, slice]]:
    """The lines of a branch, each with its stability and the points along it. Between two points of another stability
    it is that of the first, but of the second behind a fold, which is neither."""
    if stability.size < 2:
        yield str(stability[0]), slice(0, 1)
        return
    between = np.where(critical[:-1], stability[1:], stability[:-1])
    begins = [0, *(np.flatnonzero(between[1:] != between[:-1]) + 1).tolist(), between.size]
    for first, last in zip(begins, begins[1:]):
        yield str(between[first]), slice(first, last + 1)


def plot_curve(curve: Curve, quantity: str | None, ax: Any) -> Any:
    """A quantity over the varied number: unstable parts dashed, folds as points, snaps as arrows."""
    if len(curve) == 0:
        raise _poise.InputError(f"plot: there are no points to draw: {curve.why or curve.verdict}")
    name = default_quantity(curve) if quantity is None else checked_name(quantity)
    parameter, values = curve[curve.number], numbers_to_draw(name, curve[name])
    columns = curve.columns
    stability = columns["stability"] if "stability" in columns else np.full(len(curve), "stable")
    critical = columns["proof"] == "critical" if "proof" in columns else np.full(len(curve), False)
    ax = axes(ax)
    named: set[str] = set()
    for branch in curve.branches:
        x, y = parameter[branch.points], values[branch.points]
        for word, part in lines_of(stability[branch.points], critical[branch.points]):
            label = word if word not in named else None
            named.add(word)
            ax.plot(x[part], y[part], LINES.get(word, ":"), color="C0", label=label)
    plot_events(curve, name, ax)
    ax.set_xlabel(with_unit(curve.number, curve.unit(curve.number)))
    ax.set_ylabel(with_unit(name, curve.unit(name)))
    if len(ax.get_legend_handles_labels()[1]) > 1:
        ax.legend()
    return ax


def default_quantity(curve: Curve) -> str:
    """What `poise path` shows: what was asked for first, or what changes most."""
    for point in curve._known.get("points", []):
        for name in point.get("measures", {}):
            return str(name)
    if "second" in curve._known:
        return str(curve._known["second"]["name"])
    taken = ("scene", "branch", "parameter", "stability", "proof", "effort")
    return next((name for name in curve.columns if name not in taken), "parameter")


def plot_events(curve: Curve, name: str, ax: Any) -> None:
    """Folds as points, snaps as arrows to where they land."""
    factors = curve._factor(curve.number), curve._factor(name)

    def place(point: PathPoint) -> tuple[float, float]:
        try:
            value = float(point[curve._written(name)])
        except _poise.InputError:  # what a point of the data does not have, such as a stress
            value = float("nan")
        return point["parameter"] * factors[0], value * factors[1]

    events = curve._events_showing(name)
    folds = [place(event) for event in events if event["kind"] == "fold"]
    if folds:
        x, y = zip(*folds)
        ax.plot(x, y, "o", color="C3", label="fold")
    for event in events:
        if event["kind"] == "snap" and event["landing"] is not None:
            ax.annotate("", xy=place(event["landing"]), xytext=place(event),
                        arrowprops={"arrowstyle": "->", "color": "C3", "linestyle": ":", "shrinkA": 0, "shrinkB": 0})


def plot_motion(motion: Motion, names: Sequence[str], ax: Any) -> Any:
    """Columns over time."""
    columns = motion.columns
    if not names:
        names = [name for name in motion._known["angles"] if name in columns]
    if not names:
        names = [name for name in columns if name not in ("time", "confirmed")][:1]
    if not names:
        raise _poise.InputError(f"plot: there are no times to draw: {motion.verdict}")
    values = [numbers_to_draw(name, motion[name]) for name in names]
    units = [motion.unit(name) for name in names]
    same = len(set(units)) == 1
    ax = axes(ax)
    for name, unit, value in zip(names, units, values):
        ax.plot(motion.time, value, label=name if same else with_unit(name, unit))
    ax.set_xlabel("time (s)")
    ax.set_ylabel(with_unit(names[0] if len(names) == 1 else "", units[0]) if same else "")
    if len(names) > 1:
        ax.legend()
    return ax


def plot_fit(fit: Fit, sensor: str | None, run: str | None, residuals: bool, ax: Any) -> Any:
    """Readings and prediction of a sensor over time, a colour for each run; or its residuals."""
    sensors = [str(one["name"]) for one in fit._known.get("sensors", [])]
    name = next(iter(sensors), "") if sensor is None else checked_name(sensor)
    if name not in sensors:
        raise unknown("the name of a sensor", name, sensors)
    columns = fit.columns
    if name not in columns:
        raise _poise.InputError(f"plot: there are no readings to draw: {fit.verdict}")
    runs = list(dict.fromkeys(columns["run"].tolist()))
    if run is not None and checked_name(run) not in runs:
        raise unknown("the name of a run", run, runs)
    ax = axes(ax)
    for k, shown in enumerate(runs if run is None else [run]):
        of = (columns["run"] == shown) & np.isfinite(columns[name])
        time = columns["time"][of]
        if residuals:
            ax.plot(time, columns[name + ".residual"][of], ".", markersize=2, color=f"C{k}", label=shown)
        else:
            ax.plot(time, columns[name][of], ".", markersize=2, alpha=0.4, color=f"C{k}")
            ax.plot(time, columns[name + ".prediction"][of], "-", linewidth=1, color=f"C{k}", label=shown)
    ax.set_xlabel("time (s)")
    ax.set_ylabel(with_unit(name + (".residual" if residuals else ""), columns.unit(name)))
    ax.legend(fontsize="small")
    return ax


def plot_tolerance(tolerance: Tolerance, quantity: str | None, ax: Any) -> Any:
    """The histogram of the samples, the nominal value and the band of first order."""
    bands = tolerance.bands
    name = next(iter(bands), "") if quantity is None else checked_name(quantity)
    if name not in bands:
        raise unknown("a quantity that has a band", name, list(bands))
    band = bands[name]
    if len(band["histogram"]) == 0:
        raise _poise.InputError(f"plot: there are no samples of {name} to draw: {band['why'] or tolerance.verdict}")
    ax = axes(ax)
    ax.stairs(band["histogram"], band["histogram_edges"], fill=True, alpha=0.6, label="samples")
    ax.axvline(band["nominal"], color="C3", label="nominal")
    for side in (-1, 1):
        ax.axvline(band["nominal"] + side * band["worst"], color="C3", linestyle=":",
                   label="worst of first order" if side < 0 else None)
    ax.set_xlabel(with_unit(name, str(band["unit"])))
    ax.set_ylabel("samples")
    ax.legend()
    return ax


# ---- The mechanism ----


def plot_positions(positions: Sequence[Mapping[str, Any]], labels: Sequence[str], unit: str, ax: Any) -> Any:
    """Positions of one mechanism over each other, each in a colour where there are several."""
    drawn = [(data, label) for data, label in zip(positions, labels) if data.get("points")]
    if not drawn:
        raise _poise.InputError("plot: there is no position to draw")
    ax = axes(ax)
    for k, (data, label) in enumerate(drawn):
        draw_bodies(ax, data["points"], "0.35" if len(drawn) == 1 else f"C{k}", label)
        draw_forces(ax, data.get("forces_on_bodies") or [])
    ax.set_aspect("equal", adjustable="datalim")
    ax.set_xlabel(with_unit("x", unit))
    ax.set_ylabel(with_unit("y", unit))
    if len(drawn) > 1:
        ax.legend()
    return ax


def draw_bodies(ax: Any, points: Mapping[str, Sequence[float]], color: str, label: str) -> None:
    """Each body as the hull of its points, and the points of the ground."""
    bodies: dict[str, list[Sequence[float]]] = {}
    for name, place in points.items():
        bodies.setdefault(name.rpartition(".")[0], []).append(place)
    fixed = np.array(bodies.pop("ground", [])).reshape(-1, 2)
    for k, places in enumerate(bodies.values()):
        outline = hull(np.array(places))
        closed = np.vstack([outline, outline[:1]])
        ax.fill(closed[:, 0], closed[:, 1], color=color, alpha=0.15, linewidth=0)
        ax.plot(closed[:, 0], closed[:, 1], "-", color=color, linewidth=2, label=label if k == 0 and label else None)
        ax.plot(*np.array(places).T, "o", color=color, markerfacecolor="white", markersize=5)
    ax.plot(fixed[:, 0], fixed[:, 1], "^", color="black", markersize=8, zorder=1)


def hull(points: Array) -> Array:
    """The corners of the convex hull, counter-clockwise (Andrew's monotone chain)."""
    ordered = sorted({(float(x), float(y)) for x, y in points})
    if len(ordered) < 3:
        return np.array(ordered)

    def half(along: Sequence[tuple[float, float]]) -> list[tuple[float, float]]:
        out: list[tuple[float, float]] = []
        for p in along:
            while len(out) > 1 and ((out[-1][0] - out[-2][0]) * (p[1] - out[-2][1])
                                    - (out[-1][1] - out[-2][1]) * (p[0] - out[-2][0])) <= 0.0:
                out.pop()
            out.append(p)
        return out[:-1]

    return np.array(half(ordered) + half(ordered[::-1]))


def draw_forces(ax: Any, forces: Sequence[Mapping[str, Any]]) -> None:
    """Springs and bars between the two points on which they act, loads as arrows."""
    ends: dict[tuple[str, str], list[Array]] = {}
    for one in forces:
        at, kind = np.array(one["at"], dtype=float), str(one["kind"])
        if kind == "force" and np.any(one["force"]):
            direction = np.array(one["force"]) / np.hypot(*one["force"])
            ax.quiver(*at, *direction, color="C3", angles="xy", scale=12, width=0.006, zorder=3)
        elif kind not in ("weight", "torque", "stop"):
            ends.setdefault((kind, str(one["name"])), []).append(at)
    for (kind, _), places in ends.items():
        if len(places) == 2 and np.any(places[0] != places[1]):
            line = np.array(places) if kind == "bar" else zigzag(places[0], places[1])
            ax.plot(line[:, 0], line[:, 1], "-", color="0.35" if kind == "bar" else "C2", linewidth=1.5, zorder=1)


def zigzag(first: Array, last: Array, turns: int = 8) -> Array:
    """A spring between two points, shape (n, 2)."""
    along = last - first
    across = 0.06 * np.array([-along[1], along[0]])
    places = [first, first + 0.15 * along]
    places += [first + (0.15 + 0.7 * (k + 0.5) / turns) * along + (1 if k % 2 else -1) * across for k in range(turns)]
    return np.array([*places, first + 0.85 * along, last])
