"""What commands find, as Python sees it."""

from __future__ import annotations

import dataclasses
import json
import os
import pathlib
import shutil
import zlib
from typing import Any, Callable, Iterator, Mapping, Sequence, TypeVar, Union, overload

import numpy as np

from . import _pictures, _poise
from ._tables import Array, Column, Matrix, Record, Table, checked_name, float_of, frozen, needed, si_unit, unknown
from ._tables import write_file

LEVELS = ("quiet", "normal", "verbose")
Self = TypeVar("Self", bound="Found")


class Call:
    """A call of a command, which can be made again: for pictures that were not made at first, or for more quantities.

    ``options`` are those of the command line with their words, ``scene`` takes the place of its file.
    """

    def __init__(self, command: str, options: Sequence[tuple[str, str]], scene: _poise.Scene | None = None) -> None:
        self.command = command
        self.options = list(options)
        self.scene = scene

    def __call__(self, show: Sequence[str] = (), pictures: bool = True) -> _poise.Outcome:
        """The same once more; with quantities ``show`` in place of those that were shown. Raises InputError, for a
        quantity that is none."""
        options = [*self.bare(), *(("--show", name) for name in show)] if show else self.options
        return _poise.call(self.command, options, self.scene, pictures, None)

    def bare(self) -> list[tuple[str, str]]:
        """The options without those that show quantities."""
        return [one for one in self.options if one[0] not in ("--show", "--measure")]

    def __reduce__(self) -> Any:
        scene = None if self.scene is None else (self.scene.text, self.scene.name, self.scene.changes)
        return (_call_of, (self.command, self.options, scene))


def _call_of(
    command: str, options: list[tuple[str, str]], scene: tuple[str, str, list[tuple[str, float]]] | None
) -> Call:
    return Call(command, options, None if scene is None else _poise.Scene.parse(*scene))


@dataclasses.dataclass(frozen=True)
class Kept:
    """All that an outcome says, without the work that it came from; it has the same members, and can be pickled."""

    code: int
    verdict: str
    warnings: list[str]
    texts: tuple[str, ...]
    data: bytes  # the text of the JSON, compressed: it is long
    lines: str
    marked: str
    html: str
    svg: str
    written: str
    csv_columns: dict[str, Column]
    all_tables: dict[str, dict[str, Column]]

    @staticmethod
    def of(core: Core, pictured: Core | None) -> Kept:
        """What ``core`` says, with the pictures of ``pictured``; None where these can be made again."""
        return Kept(core.code, core.verdict, list(core.warnings), tuple(core.text(k) for k in range(len(LEVELS))),
                    zlib.compress(core.json().encode(), 1), core.csv(), core.markdown(),
                    pictured.page() if pictured is not None else "", pictured.svg if pictured is not None else "",
                    core.written, dict(core.columns()), dict(core.tables()))

    def text(self, level: int = 1) -> str:
        return self.texts[level]

    def to_dict(self) -> dict[str, Any]:
        return dict(json.loads(self.json()))

    def json(self) -> str:
        return zlib.decompress(self.data).decode()

    def csv(self) -> str:
        return self.lines

    def markdown(self) -> str:
        return self.marked

    def page(self) -> str:
        return self.html

    def columns(self) -> dict[str, Column]:
        return self.csv_columns

    def tables(self) -> dict[str, dict[str, Column]]:
        return self.all_tables


Core = Union[_poise.Outcome, Kept]


class Found:
    """What a command found: its verdict, its data, its text and its pictures.

    ``code`` is the exit code of the command line: 0 found and confirmed, 1 not; ``bool(found)`` is True for 0.
    ``verdict`` is one sentence, ``warnings`` are what a reader must not miss. ``found[name]`` is a column of the CSV
    table (a NumPy array over its rows), a quantity that was asked for (a float, nan where it is undefined), or a member
    of the data with points between its parts, ``found["range.lower.value"]``.

    Values are in the units of the scene. ``found.si`` is a view of the same in SI units: its columns and quantities;
    the members of JSON objects, texts and pictures stay in the scene's.

    >>> import poise
    >>> rest = poise.load("datasets/toggle_clamp.toml").solve()
    >>> rest.verdict
    'In equilibrium, proved: stable.'
    """

    _pictured: Core | None = None
    _columns: Table | None = None
    _data: Mapping[str, Any] | None = None
    _in_si = False

    def __init__(self, core: Core, again: Callable[..., Core] | None = None) -> None:
        """``core`` is what was found. ``again()`` finds it once more with pictures, where ``core`` has none (Call)."""
        self._core = core
        self._again = again

    # What the parts below are made of.

    def _outcome(self) -> Core:
        return self._core

    def _with_pictures(self) -> Core:
        if self._pictured is None:
            made = self._outcome() if self._again is None else self._again()
            if self._again is not None and getattr(made, "interrupted", False):
                raise KeyboardInterrupt  # what was interrupted is no picture of this
            self._pictured = made
        return self._pictured

    @property
    def _known(self) -> Mapping[str, Any]:
        """The data, which nobody changes."""
        if self._data is None:
            self._data = self._outcome().to_dict()
        return self._data

    # What it says.

    @property
    def code(self) -> int:
        """The exit code of the command line: 0 found and confirmed, 1 not."""
        return int(self._outcome().code)

    def __bool__(self) -> bool:
        return self.code == 0

    @property
    def verdict(self) -> str:
        """One sentence: what was found, and whether that is confirmed."""
        return str(self._outcome().verdict)

    @property
    def warnings(self) -> list[str]:
        """Sentences that a reader must not miss."""
        return list(self._outcome().warnings)

    def to_dict(self) -> dict[str, Any]:
        """The data, as ``--json`` writes them (docs/json.md): what is undefined is None."""
        return dict(self._outcome().to_dict())

    def json(self) -> str:
        """The same as text, as the file that ``--json`` writes."""
        return str(self._outcome().json())

    def text(self, level: str = "normal") -> str:
        """The report as text. ``level`` is ``quiet``, ``normal`` or ``verbose``; raises InputError for another."""
        if level not in LEVELS:
            raise _poise.InputError(f"level: expected quiet, normal or verbose, found {level!r}")
        return str(self._outcome().text(LEVELS.index(level)))

    def __str__(self) -> str:
        return self.text()

    def __repr__(self) -> str:
        return self.text().rstrip("\n")

    @property
    def csv(self) -> str:
        """The table that ``--csv`` writes; "" where there is none."""
        return str(self._outcome().csv())

    @property
    def markdown(self) -> str:
        """The report in Markdown."""
        return str(self._outcome().markdown())

    @property
    def written(self) -> str:
        """The scene or experiment that was found, as its file would be; "" where there is none."""
        return str(self._outcome().written)

    # Its numbers.

    @property
    def si(self: Self) -> Self:
        """A view of the same in SI units."""
        other = object.__new__(type(self))
        other.__dict__.update(self.__dict__)
        other._columns = None
        other._in_si = True
        return other

    @property
    def columns(self) -> Table:
        """The columns of the table that ``--csv`` writes, arrays over its rows; none where there is no such table."""
        if self._columns is None:
            self._columns = Table(self._outcome().columns(), self._in_si)
        return self._columns

    @property
    def tables(self) -> dict[str, Table]:
        """The tables of the data by their place in it: ``"reactions"``, ``"identifiability.correlation"``.

        They are in the units of the scene, as the JSON has them. Of a view in SI they are refused: not all of their
        columns tell their unit."""
        if self._in_si:
            raise _poise.InputError("tables: they are in the units of the scene; expected them without .si")
        return {name: Table(columns, self._in_si) for name, columns in self._outcome().tables().items()}

    def _quantities(self) -> dict[str, Mapping[str, Any]]:
        """The quantities that were asked for, those of one value."""
        listed = self._known.get("quantities", [])
        return {one["name"]: one for one in listed if isinstance(one, dict) and "name" in one and "value" in one}

    def __getitem__(self, name: str) -> Any:
        checked_name(name)
        if name in self.columns:
            return self.columns[name]
        if name in (quantities := self._quantities()):
            factor = si_unit(quantities[name]["unit"])[1] if self._in_si else 1.0
            return float_of(quantities[name]["value"]) * factor
        return self._member(name)

    def _member(self, name: str) -> Any:
        found: Any = self._known
        for part in name.split("."):
            if isinstance(found, list) and part.isdigit() and int(part) < len(found):
                found = found[int(part)]
            elif isinstance(found, Mapping) and part in found:
                found = found[part]
            else:
                raise unknown("a column, a quantity or a member of the data", name, list(self.keys()))
        return Record(found) if isinstance(found, dict) else found

    def keys(self) -> Sequence[str]:
        """The names that ``found[name]`` takes: columns, quantities and members of the data."""
        return list(dict.fromkeys([*self.columns, *self._quantities(), *self._known]))

    def __iter__(self) -> Iterator[Any]:
        return iter(self.keys())

    def unit(self, name: str) -> str:
        """The unit of a column or quantity; "" of what has none. Raises InputError for a name that is none."""
        if checked_name(name) in self.columns:
            return self.columns.unit(name)
        if name in (quantities := self._quantities()):
            unit = str(quantities[name]["unit"])
            return si_unit(unit)[0] if self._in_si else unit
        raise unknown("a column or a quantity", name, [*self.columns, *quantities])

    def to_frame(self, table: str | None = None) -> Any:
        """A pandas DataFrame of the table that ``--csv`` writes, or of one of ``tables``.

        Raises ImportError without pandas, InputError where there is no such table.
        """
        if table is None:
            if len(self.columns) == 0:
                raise unknown("the name of a table, because there is no CSV of this", "table", list(self.tables))
            return self.columns.to_frame()
        tables = self.tables
        if table not in tables:
            raise unknown("the name of a table", table, list(tables))
        return tables[table].to_frame()

    # Its pictures.

    @property
    def svg(self) -> str:
        """The drawing or chart as SVG; "" where there is nothing to draw. Made when it is first asked for."""
        return str(self._with_pictures().svg)

    @property
    def page(self) -> str:
        """A page for the browser, HTML that loads nothing: report, pictures that move, and the data."""
        return str(self._with_pictures().page())

    def plot(self, *what: Any, **options: Any) -> Any:
        """A chart in matplotlib, whose axes are returned. Raises InputError, because this has none: ``svg`` is the
        picture of the command line."""
        raise _poise.InputError("plot: there is no chart of this in matplotlib; expected .svg or .page to be shown")

    def _repr_html_(self) -> str:
        return _pictures.html_of(self)

    def _repr_mimebundle_(self, include: Any = None, exclude: Any = None) -> dict[str, str]:
        """What a notebook shows: the picture, the same with its table, and the report as text."""
        bundle = {"text/plain": repr(self), "text/html": self._repr_html_()}
        if self.svg:
            bundle["image/svg+xml"] = self.svg
        return {kind: shown for kind, shown in bundle.items()
                if (not include or kind in include) and (not exclude or kind not in exclude)}

    def save(self, file: str | os.PathLike[str]) -> None:
        """Write it to a file, by its ending: .json .svg .html .csv .md, and .toml of a scene that was found.

        Raises InputError for another ending, where there is nothing to write, and where it cannot be written.
        """
        path = pathlib.Path(file)
        makers: dict[str, Callable[[], str]] = {
            ".json": self.json, ".svg": lambda: self.svg, ".html": lambda: self.page, ".csv": lambda: self.csv,
            ".md": lambda: self.markdown, ".toml": lambda: self.written}
        if path.suffix.lower() not in makers:
            raise _poise.InputError(f"{path}: expected an ending .json, .svg, .html, .csv, .md or .toml, "
                                    f"found {path.suffix or 'none'!r}")
        made = makers[path.suffix.lower()]()
        if not made:
            needs = path.suffix.lower() == ".svg" and shutil.which("gnuplot") is None
            raise _poise.InputError(f"{path}: this has no {path.suffix[1:]} to write" + (
                "; a chart needs gnuplot, which was not found; install gnuplot-nox, or save .html" if needs else ""))
        write_file(path, made)

    # Copies. A result never changes.

    def __copy__(self: Self) -> Self:
        return self

    def __deepcopy__(self: Self, memo: Any) -> Self:
        return self

    def __reduce__(self) -> Any:
        again = self._again if isinstance(self._again, Call) else None
        pictured = self._with_pictures() if again is None else self._pictured
        kept = Kept.of(self._outcome(), pictured)
        return (_revived, (type(self), kept, again, pictured is not None, self._in_si))


def _revived(kind: type[Self], kept: Kept, again: Call | None, is_pictured: bool, in_si: bool) -> Self:
    for column in [*kept.csv_columns.values(), *(c for t in kept.all_tables.values() for c in t.values())]:
        if not isinstance(column, list):
            column[0].flags.writeable = False
    out = kind(kept, again)
    if is_pictured:
        out._pictured = kept
    return out.si if in_si else out


class Columned(Found):
    """What is found for each point, time or position: ``found[name]`` is an array over them.

    Quantities that are no column yet are found by making the call once more, which asks for them too.
    """

    _shown: dict[str, Core]
    _shown_as: dict[str, str]

    def __init__(self, core: Core, again: Callable[..., Core] | None = None) -> None:
        super().__init__(core, again)
        self._shown = {}
        self._shown_as = {}

    def _key(self, name: str) -> str:
        """The column of a name that may be written in another way."""
        return name

    def _known_as(self, name: str) -> str | None:
        """The column of a name; None where there is none."""
        for key in (name, self._key(name)):
            if key in self.columns:
                return key
        return None

    def _shown_in(self, name: str) -> Table:
        """The columns of the call that was made again to show a quantity too."""
        if not isinstance(self._again, Call):
            raise unknown(f"a column (other quantities are asked for by show={name!r})", name, list(self.keys()))
        if name not in self._shown:
            self._shown[name] = self._again(show=[name], pictures=False)
        table = Table(self._shown[name].columns(), self._in_si)
        if table.rows != self.columns.rows:
            raise _poise.InputError(f"{name}: this is not known of what was found before the work was interrupted")
        if name not in table and name not in self._shown_as:
            # An expression is written in one way in tables, "-1 * angle.arm": in the only column that is shown there.
            bare = Call(self._again.command, self._again.bare(), self._again.scene)(pictures=False).columns()
            more = [column for column in table if column not in bare]
            if len(more) != 1 or "," in name:
                del self._shown[name]
                raise unknown("the name of one column", name, list(self.columns))
            self._shown_as[name] = more[0]
        return table

    def _written(self, name: str) -> str:
        """The name of a quantity as tables have it."""
        return self._shown_as.get(name, name)

    def __getitem__(self, name: str) -> Any:
        """An array over the rows, read-only; nan where a quantity is undefined. Raises InputError for unknown names."""
        key = self._known_as(checked_name(name))
        if key is not None:
            return self.columns[key]
        if name in self._known:
            return self._member(name)
        shown = self._shown_in(name)
        return shown[self._written(name)]

    def unit(self, name: str) -> str:
        """The unit of a column; "" of one without."""
        key = self._known_as(checked_name(name))
        if key is not None:
            return self.columns.unit(key)
        shown = self._shown_in(name)
        return shown.unit(self._written(name))

    def keys(self) -> Sequence[str]:
        """The names of the columns; quantities of docs/quantities.md are understood too."""
        return list(self.columns)

    def __len__(self) -> int:
        """How many rows there are."""
        return self.columns.rows


def _pose_key(name: str, columns: Table) -> str:
    """The column of an angle or travel, which has the name of the body or joint alone."""
    family, point, item = name.partition(".")
    return item if point and family in ("angle", "travel") and item in columns else name


class PathPoint(Record):
    """A point of a path: ``point["load.P"]`` is the varied number, ``point["angle.arm"]`` a quantity shown there."""

    def __init__(self, members: Mapping[str, Any], number: str) -> None:
        super().__init__(members)
        self._number = number

    def __getitem__(self, name: str) -> Any:
        if checked_name(name) == self._number and "parameter" in self._members:
            return self._members["parameter"]
        if name in (measures := self._members.get("measures", {})):
            return float_of(measures[name])
        family, _, item = name.partition(".")
        pose = self._members.get({"angle": "angles", "travel": "slides"}.get(family, ""), {})
        if item in pose:
            return pose[item]
        value = super().__getitem__(name)
        return PathPoint(value._members, self._number) if name == "landing" and isinstance(value, Record) else value

    def __repr__(self) -> str:
        what = self._members.get("kind", self._members.get("stability"))
        shown = {self._number: self._members.get("parameter"), **self._members.get("measures", {})}
        return f"<{what} at {', '.join(f'{name} = {float_of(value):.8g}' for name, value in shown.items())}>"


class Branch:
    """A branch of a curve: ``branch[name]`` is the part of ``curve[name]`` that belongs to it, a view of it."""

    def __init__(self, curve: Curve, points: slice, members: Mapping[str, Any]) -> None:
        self._curve = curve
        self.points = points
        self.members = Record(members)

    def __getitem__(self, name: str) -> Array:
        part: Array = self._curve[name][self.points]
        return part

    def __len__(self) -> int:
        return int(self.points.stop - self.points.start)

    @property
    def end(self) -> str:
        """How it ends: range, closed, blocked, snapped, singular, stuck, limit, interrupted."""
        return str(self.members.get("end", ""))

    @property
    def why(self) -> str:
        """Why it ends there, in a sentence."""
        return str(self.members.get("why", ""))

    def __repr__(self) -> str:
        return f"<{len(self)} points, ends: {self.end}>" if self.end else f"<{len(self)} points>"


class Curve(Columned):
    """A path of equilibria: ``curve[name]`` is an array over its points, branch by branch, in the order of the path.

    ``curve["load.P"]`` is the varied number, ``curve["force.rubber"]`` any quantity of docs/quantities.md. Branches
    follow each other: ``curve.branches`` has the part of each, so that no line is drawn from one to the next.

    >>> import poise
    >>> curve = poise.load("datasets/toggle_clamp.toml").path("load.P", 0, 60)
    >>> [event.kind for event in curve.events][:2]
    ['stop', 'fold']
    >>> round(curve.folds[0]["load.P"], 4)
    37.0934
    """

    @property
    def number(self) -> str:
        """The name of the varied number; of a curve of folds the first of both."""
        return str((self._known.get("parameter") or self._known["first"])["name"])

    def _key(self, name: str) -> str:
        if name == self.number:
            return "parameter"
        return _pose_key(name, self.columns)

    @property
    def status(self) -> str:
        """traced, incomplete (some branch ended early), no start, interrupted."""
        return str(self._known.get("status", ""))

    @property
    def why(self) -> str:
        """The same in a sentence."""
        return str(self._known.get("why", ""))

    @property
    def stability(self) -> Array:
        """stable, unstable, neutral or unknown, an array of str over the points."""
        return self.columns["stability"]

    @property
    def proved(self) -> Array:
        """Whether each point is proved, an array of bool."""
        return frozen(np.array(self.columns["proof"] == "proved"))

    @property
    def branch(self) -> Array:
        """The number of the branch of each point, from 1, an array of int."""
        return frozen(self.columns["branch" if "branch" in self.columns else "curve"].astype(int))

    @property
    def branches(self) -> list[Branch]:
        """The branches, each a part of the points."""
        numbers = self.branch
        if numbers.size == 0:
            return []
        scenes = self.columns["scene"] if "scene" in self.columns else np.zeros(numbers.size, dtype=int)
        changes = np.flatnonzero((np.diff(numbers) != 0) | (scenes[1:] != scenes[:-1])) + 1
        begins = [0, *changes.tolist(), numbers.size]
        members = self._known.get("branches") or self._known.get("curves") or []
        return [Branch(self, slice(first, last), members[k] if k < len(members) else {})
                for k, (first, last) in enumerate(zip(begins, begins[1:]))]

    @property
    def events(self) -> list[PathPoint]:
        """Folds, snaps, stops that come on or off (docs/json.md, ``events[]``), in the units of the scene."""
        return [PathPoint(event, self.number) for event in self._known.get("events", [])]

    @property
    def folds(self) -> list[PathPoint]:
        """The events that are folds."""
        return [event for event in self.events if event["kind"] == "fold"]

    @property
    def at(self) -> dict[float, list[PathPoint]]:
        """The equilibria at the values of ``at=``."""
        return {one["parameter"]: [PathPoint(point, self.number) for point in one["equilibria"]]
                for one in self._known.get("at", [])}

    def _factor(self, name: str) -> float:
        """What turns a value of the data into one of the view."""
        if not self._in_si:
            return 1.0
        key = self._known_as(name)
        columns = self._core.columns() if key is not None else self._shown[name].columns()
        column = columns[key or self._written(name)]
        return 1.0 if isinstance(column, list) else si_unit(column[1])[1]

    def _events_showing(self, name: str) -> list[PathPoint]:
        """The events with a quantity that may have been asked for later."""
        if self._known_as(name) is not None or name not in self._shown:
            return self.events
        return [PathPoint(event, self.number) for event in self._shown[name].to_dict().get("events", [])]

    def plot(self, quantity: str | None = None, ax: Any = None) -> Any:
        """The quantity over the varied number, as matplotlib axes: unstable parts dashed, folds as points, snaps as
        arrows.

        Without ``quantity`` it is what ``poise path`` shows: what changes most. ``ax`` are axes to draw in.
        """
        return _pictures.plot_curve(self, quantity, ax)


class Position(Record):
    """One of several equilibria: ``position["angle.arm"]``, ``position.energy``, ``position.stability``."""

    def __init__(self, members: Mapping[str, Any], of: Equilibria, index: int) -> None:
        super().__init__(members)
        self._of = of
        self._index = index

    def __getitem__(self, name: str) -> Any:
        if checked_name(name) in self._members:
            return super().__getitem__(name)
        return self._of[name][self._index]

    def __repr__(self) -> str:
        energy = self._members.get("energy")
        return f"<{self._index}: {self._members.get('stability')}{'' if energy is None else f', energy {energy:.6g}'}>"


class Equilibria(Columned, Sequence[Any]):
    """All equilibria, a sequence of positions by energy: ``equilibria[0].energy``, ``equilibria[0]["reaction.B"]``.

    ``equilibria["angle.arm"]`` is an array over them. ``claim`` says whether they are all.

    >>> import poise
    >>> equilibria = poise.load("datasets/toggle_clamp.toml").equilibria()
    >>> len(equilibria), equilibria.claim, [one.stability for one in equilibria]
    (3, 'complete', ['stable', 'stable', 'unstable'])
    """

    def _key(self, name: str) -> str:
        return _pose_key(name, self.columns)

    @overload
    def __getitem__(self, name: int) -> Position: ...

    @overload
    def __getitem__(self, name: slice) -> list[Position]: ...

    @overload
    def __getitem__(self, name: str) -> Any: ...

    def __getitem__(self, name: int | slice | str) -> Any:
        if isinstance(name, str):
            return super().__getitem__(name)
        if isinstance(name, slice):
            return [self[k] for k in range(*name.indices(len(self)))]
        index = range(len(self))[name]
        members = dict(self._known["equilibria"][index])
        if self._in_si:
            members.update((str(key), self[str(key)][index]) for key in members if key in self.columns)
        return Position(members, self, index)

    def __iter__(self) -> Iterator[Position]:
        return (self[k] for k in range(len(self)))

    def __len__(self) -> int:
        return len(self._known["equilibria"])

    @property
    def claim(self) -> str:
        """complete (proved), incomplete, sampled: whether they are all (docs/equilibria.md)."""
        return str(self._known["claim"])

    @property
    def settles_into(self) -> int | None:
        """The index of the one in which ``solve()`` settles; None where there is none."""
        index = self._known["settles_into"]
        return None if index is None else int(index)

    def plot(self, ax: Any = None) -> Any:
        """All positions drawn over each other, as matplotlib axes in the scene's unit of length."""
        data = self._known["equilibria"]
        labels = [f"{one['index']}: {one['stability']}" for one in data]
        return _pictures.plot_positions(data, labels, str(self._known["units"]["length"]), ax)


class Motion(Columned):
    """A motion: ``motion[name]`` is an array over ``motion.time``, in s.

    ``motion["angle.arm1"]``, ``motion["d(angle.arm1)/dt"]``, ``motion["d(d(x.arm1.elbow)/dt)/dt"]``, and any quantity
    of docs/quantities.md, such as ``motion["reaction.shoulder"]``.
    """

    def _key(self, name: str) -> str:
        of, order = name, 0
        while of.startswith("d(") and of.endswith(")/dt"):
            of, order = of[2:-4], order + 1
        family, _, item = of.partition(".")
        key = f"{item}.{family}" if family in ("x", "y") else _pose_key(of, self.columns)
        return key + ("", ".rate", ".acceleration")[order] if order < 3 else name

    @property
    def time(self) -> Array:
        """The times of the rows, in s."""
        return self.columns["time"]

    @property
    def confirmed(self) -> bool:
        """The motion ran to its end, and its error and energy balance are within their bounds."""
        return bool(self._known["confirmed"])

    def plot(self, *names: str, ax: Any = None) -> Any:
        """Columns over time, as matplotlib axes; without names the angles of all bodies, or else what was shown."""
        return _pictures.plot_motion(self, names, ax)


class Estimate(Record):
    """An estimate: ``value`` with its ``standard_error`` and 95 % interval ``low`` to ``high``, in ``unit``;
    ``float()`` of it is the value. nan where the data do not tell."""

    def __getitem__(self, name: str) -> Any:
        value = super().__getitem__(name)
        return float_of(value) if name in ("value", "standard_error", "low", "high") else value

    def __float__(self) -> float:
        return float_of(self._members["value"])

    def __repr__(self) -> str:
        return f"{float(self):.6g} +- {self['standard_error']:.2g} {self['unit']}".rstrip()


class Fit(Found):
    """Numbers that were identified: ``fit["body.arm.mass"]`` is an estimate with its error, by path or by name.

    ``fit.columns`` are the readings with what the model predicts: ``run``, ``time``, and for each sensor ``angle``,
    ``angle.prediction``, ``angle.residual``.

    >>> import poise
    >>> fit = poise.identify("datasets/lift_experiment.toml")
    >>> fit["body.lump.mass"].unit, round(float(fit["mP"]))
    ('kg', 65)
    >>> fit.covariance.names
    ('mP', 'J_O', 'k', 'c')
    """

    def _scaled(self, estimate: Mapping[str, Any]) -> Mapping[str, Any]:
        if not self._in_si:
            return estimate
        factor = float(estimate["unit_si"])
        out = dict(estimate, unit=si_unit(estimate["unit"])[0], unit_si=1.0)
        for name in ("value", "standard_error", "low", "high", "standard_error_runs", "standard_error_serial",
                     "standard_error_white", "scene_value", "truth"):
            if isinstance(out.get(name), float):
                out[name] *= factor
        return out

    @property
    def estimates(self) -> dict[str, Estimate]:
        """The estimates by name, in the order of the experiment."""
        return {one["name"]: Estimate(self._scaled(one)) for one in self._known["estimates"]}

    @property
    def standard_errors(self) -> dict[str, float]:
        """Their standard errors by name; nan where the data do not tell."""
        return {name: float(one["standard_error"]) for name, one in self.estimates.items()}

    def _matrix(self, rows: Mapping[str, Mapping[str, Any]] | None, factors: Mapping[str, float]) -> Matrix:
        names = [name for name in self.estimates if rows is None or name in rows]

        def entry(row: str, column: str) -> float:
            return np.nan if rows is None else float_of(rows[row].get(column)) * factors[row] * factors[column]

        return Matrix([[entry(row, column) for column in names] for row in names], names)

    @property
    def covariance(self) -> Matrix:
        """The covariance of the estimates, shape (n, n), with their names; nan where the data do not tell."""
        return self._matrix(self._known.get("covariance"), {
            one["name"]: float(one["unit_si"]) if self._in_si else 1.0 for one in self._known["estimates"]})

    @property
    def correlation(self) -> Matrix:
        """The correlation of the estimates, shape (n, n), with their names."""
        identifiability = self._known.get("identifiability") or {}
        return self._matrix(identifiability.get("correlation"), dict.fromkeys(self.estimates, 1.0))

    def __getitem__(self, name: str) -> Any:
        checked_name(name)
        for one in self._known["estimates"]:
            if name in (one["name"], one["path"]):
                return Estimate(self._scaled(one))
        return super().__getitem__(name)

    def keys(self) -> Sequence[str]:
        """The names of the estimates, and of all else that ``fit[name]`` takes."""
        paths = [one["path"] for one in self._known["estimates"]]
        return list(dict.fromkeys([*self.estimates, *paths, *super().keys()]))

    def unit(self, name: str) -> str:
        """The unit of an estimate or a column."""
        checked_name(name)
        for one in self._known["estimates"]:
            if name in (one["name"], one["path"]):
                return str(self._scaled(one)["unit"])
        return super().unit(name)

    def to_frame(self, table: str | None = None) -> Any:
        """A pandas DataFrame of the estimates, a row for each, or of one of ``tables``; ``columns.to_frame()`` has the
        readings."""
        if table is not None:
            return super().to_frame(table)
        pandas = needed("pandas", "python3-pandas", "to_frame()")
        shown = ("path", "value", "standard_error", "low", "high", "unit")
        rows = [{name: one[name] for name in shown} for one in self.estimates.values()]
        return pandas.DataFrame(rows, index=list(self.estimates), columns=list(shown))

    def validate(self, experiment: Any, **options: Any) -> Found:
        """How well this fit predicts the runs of another experiment, a file or a poise.Experiment: the command
        validate, whose options it takes. Raises InputError."""
        from ._commands import validate

        return validate(experiment, with_=self, **options)

    def plot(
        self, sensor: str | None = None, run: str | None = None, residuals: bool = False, ax: Any = None
    ) -> Any:
        """Readings as points and prediction as lines over time, as matplotlib axes, of the first sensor and all runs
        where none is named; or the residuals."""
        return _pictures.plot_fit(self, sensor, run, residuals, ax)


class Band(Record):
    """A quantity over its tolerances: ``nominal``, ``sigma`` and ``worst`` of first order, ``continued`` and ``all`` of
    the samples, and their ``histogram`` (counts, shape (n,)) between ``histogram_edges`` (shape (n + 1,))."""

    def __getitem__(self, name: str) -> Any:
        value = super().__getitem__(name)
        return np.array(value) if name in ("histogram", "histogram_edges") else value

    def __repr__(self) -> str:
        if self._members.get("why"):
            return f"no band: {self._members['why']}"
        return f"{self['nominal']:.6g}, sigma {self['sigma']:.3g}, worst {self['worst']:.3g} {self['unit']}"


class Tolerance(Found):
    """Bands of quantities over the tolerances of a scene: ``tolerance["force.rubber"]`` is a Band."""

    @property
    def bands(self) -> dict[str, Band]:
        """The bands by the names of their quantities."""
        return {one["name"]: Band(self._scaled(one)) for one in self._known["quantities"]}

    def _scaled(self, band: Mapping[str, Any]) -> Mapping[str, Any]:
        if not self._in_si:
            return band
        unit, factor = si_unit(band["unit"])
        out = dict(band, unit=unit)
        for name in ("nominal", "sigma", "worst", "at_least", "at_most", "second_order_mean", "second_order_sigma"):
            out[name] = None if band[name] is None else band[name] * factor
        for name in ("continued", "all"):
            out[name] = {key: value if value is None or key == "count" else value * factor
                         for key, value in band[name].items()}
        out["histogram_edges"] = [edge * factor for edge in band["histogram_edges"]]
        return out

    def __getitem__(self, name: str) -> Any:
        bands = self.bands
        return bands[name] if checked_name(name) in bands else super().__getitem__(name)

    def keys(self) -> Sequence[str]:
        """The names of the quantities, and of all else that ``tolerance[name]`` takes."""
        return list(dict.fromkeys([*self.bands, *super().keys()]))

    def unit(self, name: str) -> str:
        """The unit of a quantity or a column."""
        bands = self.bands
        return str(bands[name]["unit"]) if checked_name(name) in bands else super().unit(name)

    def plot(self, quantity: str | None = None, ax: Any = None) -> Any:
        """The histogram of the samples of a quantity, of the first one without a name, as matplotlib axes."""
        return _pictures.plot_tolerance(self, quantity, ax)


#: The class of what a command finds, where it is not Found.
FOUND_CLASSES: dict[str, type[Found]] = {
    "equilibria": Equilibria,
    "identify": Fit,
    "motion": Motion,
    "path": Curve,
    "tolerance": Tolerance,
}
