"""Many variants of a scene at once: their equilibria and their paths."""

from __future__ import annotations

import copy
from typing import TYPE_CHECKING, Any, Callable, Iterator, Mapping, Sequence

import numpy as np

from . import _poise
from ._pictures import axes
from ._tables import ByName, Record, checked_name, checked_text, frozen, needed, refuse_mask, si_unit, unknown

if TYPE_CHECKING:
    import numpy.typing as npt

    from ._found import Curve
    from ._scene import Scene

    Floats = npt.NDArray[np.float64]
    Bools = npt.NDArray[np.bool_]
    Index = int | tuple[int, ...]

_BY = ("not solved", "lanes", "search", "none")
_NOT_TRIED, _PROVED = 0, 1


class Varied:
    """The numbers in which variants differ, by their paths: arrays of one shape, or one value for all."""

    def __init__(self, what: str, core: _poise.Scene, numbers: Any) -> None:
        if not isinstance(numbers, Mapping):
            found = _poise.shown(numbers)
            raise _poise.InputError(f'{what}: expected arrays by name, {{"load.P": array}}, found {found}')
        if not numbers:
            raise _poise.InputError(f'{what}: expected numbers that vary, {{"load.P": array}}, found none')
        self.values: dict[str, Floats] = {}
        for given, value in numbers.items():
            path = core.path_of(checked_name(given))
            if path in self.values:
                raise _poise.InputError(f"{what}: {path} is given twice")
            refuse_mask(path, value)
            array = np.asarray(_poise.real_array(value, path))
            if not np.isfinite(array).all():
                at = np.argwhere(~np.isfinite(array))[0]
                place = f" at index {', '.join(map(str, at))}" if array.ndim else ""
                raise _poise.InputError(f"{path}: expected finite numbers, found {array[tuple(at)]}{place}")
            self.values[path] = array
        try:
            self.shape = np.broadcast_shapes(*(array.shape for array in self.values.values()))
        except ValueError:
            shapes = ", ".join(f"{path} {array.shape}" for path, array in self.values.items())
            raise _poise.InputError(f"{what}: expected arrays of one shape, found {shapes}") from None
        if not self.variants:
            raise _poise.InputError(f"{what}: expected at least one variant, found arrays of shape {self.shape}")
        self.units = {path: core.unit_of(path) for path in self.values}

    @property
    def variants(self) -> int:
        return int(np.prod(self.shape, dtype=np.int64))

    def kept(self) -> Varied:
        """The same with copies of the arrays, which nobody can change."""
        out = copy.copy(self)
        out.values = {path: frozen(np.array(array)) for path, array in self.values.items()}
        return out

    def flat(self) -> list[tuple[str, Floats]]:
        """A value for each variant, or one for all; without a copy where an array is contiguous and has the shape."""
        out = []
        for path, array in self.values.items():
            one_for_all = array.size == 1 and self.variants != 1
            whole = array if one_for_all else np.ascontiguousarray(np.broadcast_to(array, self.shape))
            out.append((path, whole.reshape(-1)))
        return out

    def of(self, variant: int) -> dict[str, float]:
        """The numbers of one variant."""
        return {path: float(np.broadcast_to(array, self.shape).flat[variant]) for path, array in self.values.items()}

    def index(self, at: Any) -> int:
        """The place of a variant in flat arrays. Raises InputError where there is none."""
        key = at if isinstance(at, tuple) else (at,)
        whole = all(isinstance(one, (int, np.integer)) and not isinstance(one, bool) for one in key)
        if whole and len(key) == 1 and len(self.shape) != 1 and -self.variants <= key[0] < self.variants:
            return int(key[0]) % self.variants
        fits = whole and len(key) == len(self.shape) and all(-n <= k < n for k, n in zip(key, self.shape))
        if not fits:
            found = _poise.shown(at)
            raise _poise.InputError(f"expected the index of a variant in the shape {self.shape}, found {found}")
        return int(np.ravel_multi_index(tuple(int(k) % n for k, n in zip(key, self.shape)), self.shape))

    def rows(self) -> Any:
        """The index of a DataFrame with a row for each variant."""
        pandas = needed("pandas", "python3-pandas", "to_frame()")
        if len(self.shape) <= 1:
            return pandas.RangeIndex(self.variants)
        return pandas.MultiIndex.from_product([range(n) for n in self.shape])


def _expect_varied(varied: object, otherwise: str) -> None:
    if not isinstance(varied, Varied):
        raise TypeError(otherwise)


def _listed(array: Any) -> Any:
    """Nested lists for JSON; what is not finite is None."""
    array = np.asarray(array)
    if array.dtype.kind != "f":
        return array.tolist()
    nested = array.astype(object)
    nested[~np.isfinite(array)] = None
    return nested.tolist()


def _known(value: Any) -> Any:
    return None if isinstance(value, float) and not np.isfinite(value) else value


def _spread(values: Floats) -> tuple[float, float, float, float, int]:
    """Mean, standard deviation, least and most of the values there are, and how many those are."""
    known = values[np.isfinite(values)]
    if not known.size:
        return (np.nan, np.nan, np.nan, np.nan, 0)
    return (float(known.mean()), float(known.std()), float(known.min()), float(known.max()), int(known.size))


def _histogram(values: Floats) -> str:
    """A picture of how values are spread: 30 bars in an SVG of 120 by 24."""
    known = values[np.isfinite(values)]
    if not known.size or known.min() == known.max():
        return ""
    counts, _ = np.histogram(known, 30)
    bars = "".join(
        f'<rect x="{4 * k}" y="{24 - 24 * n / counts.max():.2f}" width="3.5" height="{24 * n / counts.max():.2f}"/>'
        for k, n in enumerate(counts)
    )
    return f'<svg width="120" height="24" viewBox="0 0 120 24" fill="currentColor" role="img">{bars}</svg>'


def _html_table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """Cells that begin with a picture are taken as they are."""
    from html import escape  # here, because few need it

    def cell(text: str) -> str:
        return text if text.startswith("<svg") else escape(text)

    lines = ["".join(f"<td>{cell(text)}</td>" for text in row) for row in rows]
    names = "".join(f"<th>{escape(text)}</th>" for text in head)
    body = "".join(f"<tr>{line}</tr>" for line in lines)
    return f"<table><thead><tr>{names}</tr></thead><tbody>{body}</tbody></table>"


class Many(ByName["Floats"]):
    """The equilibria of many variants of a scene. All arrays have the `shape` of the numbers that were given.

    ``many["angle.arm"]`` are the values of a quantity that was asked for, in the units of the scene, nan where it has
    none (``why``). ``si`` is a view of the same in SI units, without copies. It pickles, and does not refer to the
    scene.
    """

    def __init__(self, title: str, varied: Varied, found: Mapping[str, Any], asked: Sequence[str], prove: bool) -> None:
        _expect_varied(varied, "Many objects come from Scene.solve_many()")
        self._title = title
        self._varied = varied
        self._found = found
        self._freeze()
        self._prove = prove
        self._in_si = False
        self._places = {name: k for k, (name, _, _) in enumerate(found["quantities"])}
        self._places.update({name: k for k, name in enumerate(asked)})

    def _freeze(self) -> None:
        for array in [*self._found.values(), *self._varied.values.values()]:
            if isinstance(array, np.ndarray):
                frozen(array)

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state)
        self._freeze()  # arrays can be written to after pickle

    @property
    def shape(self) -> tuple[int, ...]:
        """The shape of the numbers that were given, broadcast."""
        return self._varied.shape

    @property
    def variants(self) -> int:
        """How many variants there are."""
        return self._varied.variants

    @property
    def si(self) -> Many:
        """The same in SI units: views of the memory of the work."""
        out: Many = object.__new__(Many)
        out.__dict__.update(self.__dict__, _in_si=True)
        return out

    def __getitem__(self, name: str) -> Floats:
        """A quantity, or one of the numbers in which the variants differ, float64 of the `shape`, read-only."""
        place = self._places.get(checked_name(name))
        if place is None:
            if name in self._varied.values:
                numbers: Floats = frozen(np.broadcast_to(self._varied.values[name], self.shape))
                in_si = si_unit(self._varied.units[name])[1] if self._in_si else 1.0
                return numbers if in_si == 1.0 else frozen(np.asarray(numbers * in_si))
            known = [*self.keys(), *self._varied.values]
            raise unknown("a quantity that was asked for, or a number that varies", name, known)
        values: Floats = self._found["values"][:, place].reshape(self.shape)
        in_si = self._found["quantities"][place][2]
        return values if self._in_si or in_si == 1.0 else frozen(np.asarray(values / in_si))

    def __iter__(self) -> Iterator[str]:
        return iter([name for name, _, _ in self._found["quantities"]])

    def __len__(self) -> int:
        return len(self._found["quantities"])

    def __bool__(self) -> bool:
        """An equilibrium of every variant was found."""
        return bool(self.solved.all())

    def unit(self, name: str) -> str:
        """The unit of a quantity or a number."""
        if name not in self._places and name in self._varied.units:
            unit = self._varied.units[name]
        else:
            self[name]
            unit = str(self._found["quantities"][self._places[name]][1])
        return si_unit(unit)[0] if self._in_si else unit

    @property
    def coordinates(self) -> list[tuple[str, str]]:
        """Name and unit of the n coordinates `x`, as of `Scene.coordinates`."""
        return [(name, si_unit(unit)[0] if self._in_si else unit) for name, unit, _ in self._found["coordinates"]]

    @property
    def x(self) -> Floats:
        """The coordinates of the equilibria, shape (*shape, n), float64, read-only: rad, the scene's unit of length."""
        q: Floats = self._found["q"].reshape(*self.shape, -1)
        in_si = np.array([unit for _, _, unit in self._found["coordinates"]])
        out: Floats = q if self._in_si or (in_si == 1.0).all() else frozen(q / in_si)
        return out

    @property
    def by(self) -> npt.NDArray[np.str_]:
        """How each was solved: ``lanes`` (by Newton's method, together with others), ``search`` (alone, as by `solve`),
        ``none`` (no equilibrium was found), ``not solved`` (it was interrupted before)."""
        return frozen(np.array(_BY)[self._found["by"]].reshape(self.shape))

    @property
    def solved(self) -> Bools:
        """Where an equilibrium was found, bool."""
        by = self._found["by"]
        return frozen(((by == _BY.index("lanes")) | (by == _BY.index("search"))).reshape(self.shape))

    @property
    def proved(self) -> Any:
        """None where no proof was asked for. Else an array of bool; with a sample of proofs, or after an interrupt, it
        is masked where none was tried (numpy.ma): ``many.proved.all()`` is about the others."""
        if not self._prove:
            return None
        proofs = self._found["proofs"]
        proved = frozen((proofs == _PROVED).reshape(self.shape))
        tried = (proofs != _NOT_TRIED).reshape(self.shape)
        masked: Any = np.ma
        return proved if tried.all() else masked.array(proved, mask=~tried)

    @property
    def radius(self) -> Floats | None:
        """None where no proof was asked for. Else how close to `x` exactly one equilibrium is, rad or sizes of the
        mechanism; nan where that is not proved."""
        radius: Floats = self._found["radius"].reshape(self.shape)
        return radius if self._prove else None

    def why(self, variant: Index) -> str:
        """Why a variant has no equilibrium or a quantity no value there, in a sentence; "" where neither is so. Reasons
        are kept of the first 1000 such variants."""
        at = self._varied.index(variant)
        for noted, why in self._found["notes"]:
            if noted == at:
                return str(why)
        if self._found["by"][at] in (_BY.index("lanes"), _BY.index("search")):
            if not np.isnan(self._found["values"][at]).any():
                return ""
            if self.interrupted:
                return "an interrupt came before its quantities were found"
            return "a quantity has no value; reasons are kept of the first 1000 variants alone"
        if self._found["by"][at] == _BY.index("not solved"):
            return "an interrupt came before its turn"
        return "no equilibrium was found; reasons are kept of the first 1000 variants alone"

    @property
    def interrupted(self) -> bool:
        """The work was stopped before all variants were solved."""
        return bool(self._found["interrupted"])

    @property
    def simd(self) -> str:
        """The instructions that were used: ``plain``, ``avx2``, ``avx512``; POISE_SIMD chooses."""
        return str(self._found["simd"])

    @property
    def why_no_lanes(self) -> str:
        """Why no variant could be solved together with others, in a sentence; "" where they can."""
        return str(self._found["why_no_lanes"])

    def _counts(self) -> dict[str, int]:
        counts = np.bincount(self._found["by"], minlength=len(_BY))
        return {name: int(n) for name, n in zip(_BY, counts)}

    def _summary(self) -> str:
        counts = self._counts()
        parts = [f"{counts['lanes']} in lanes", f"{counts['search']} by search", f"{counts['none']} not found"]
        if counts["not solved"]:
            parts.append(f"{counts['not solved']} not solved")
        if self._prove:
            tried = int((self._found["proofs"] != _NOT_TRIED).sum())
            parts.append(f"{int((self._found['proofs'] == _PROVED).sum())} of {tried} proved")
        plural = "variant" if self.variants == 1 else "variants"
        why = f" (none in lanes: {self.why_no_lanes})" if self.why_no_lanes else ""
        return f"{self.variants} {plural} of {self._title}: {', '.join(parts)}{why}"

    def _spreads(self) -> list[list[str]]:
        rows = []
        for name in self:
            mean, sigma, least, most, known = _spread(self[name])
            missing = self.variants - known
            numbers = [f"{value:.6g}" for value in (mean, sigma, least, most)] if known else ["-"] * 4
            rows.append([name, self.unit(name), *numbers, str(missing) if missing else ""])
        return rows

    def __repr__(self) -> str:
        head = ["quantity", "unit", "mean", "sigma", "least", "most", "without"]
        rows = self._spreads()
        if not rows:
            return self._summary()
        widths = [max(len(row[k]) for row in [head, *rows]) for k in range(len(head))]
        lines = ["  ".join(text.ljust(width) for text, width in zip(row, widths)).rstrip() for row in [head, *rows]]
        return "\n".join([self._summary(), *lines])

    def _repr_html_(self) -> str:
        from html import escape

        rows = [[*row, _histogram(self[row[0]])] for row in self._spreads()]
        head = ["quantity", "unit", "mean", "sigma", "least", "most", "without", ""]
        table = _html_table(head, rows) if rows else ""
        return f"<p>{escape(self._summary())}</p>{table}"

    def to_dict(self) -> dict[str, Any]:
        """All of it in lists, numbers and texts, as for JSON; what is not known is None."""
        numbers = {
            path: {"unit": self._varied.units[path], "values": _listed(array)}
            for path, array in self._varied.values.items()
        }
        return {
            "variants": self.variants,
            "shape": list(self.shape),
            "numbers": numbers,
            "quantities": {name: {"unit": self.unit(name), "values": _listed(self[name])} for name in self},
            "coordinates": [{"name": name, "unit": unit} for name, unit in self.coordinates],
            "x": _listed(self.x),
            "by": self.by.tolist(),
            "counts": self._counts(),
            "proved": None if self.proved is None else self.proved.tolist(),
            "radius": None if self.radius is None else _listed(self.radius),
            "notes": [{"variant": variant, "why": why} for variant, why in self._found["notes"]],
            "simd": self.simd,
            "why_no_lanes": self.why_no_lanes or None,
            "interrupted": self.interrupted,
        }

    def to_frame(self) -> Any:
        """A pandas DataFrame with a row for each variant: numbers, quantities, ``by``, and, where proofs were asked
        for, ``proved`` and ``radius``. ``attrs["units"]`` has the units."""
        pandas = needed("pandas", "python3-pandas", "to_frame()")
        columns: dict[str, Any] = {name: np.ravel(self[name]) for name in [*self._varied.values, *self]}
        units = {name: self.unit(name) for name in columns}
        columns["by"] = pandas.Categorical.from_codes(self._found["by"], _BY)
        if self._prove:
            proofs = self._found["proofs"]
            columns["proved"] = pandas.array(proofs == _PROVED, dtype="boolean")
            columns["proved"][proofs == _NOT_TRIED] = pandas.NA
            columns["radius"] = self._found["radius"]
        frame = pandas.DataFrame(columns, index=self._varied.rows())
        frame.attrs["units"] = {name: unit for name, unit in units.items() if unit}
        return frame

    def plot(self, name: str | None = None, ax: Any = None, bins: int = 50) -> Any:
        """A histogram of a quantity, by default the first, as matplotlib axes."""
        if name is None and not len(self):
            raise _poise.InputError("plot: expected a quantity; name some of them by of= in solve_many()")
        of = next(iter(self)) if name is None else name
        if not 1 <= _whole("bins", bins) <= 100_000:
            raise _poise.InputError(f"bins: expected a whole number from 1 to 100000, found {bins}")
        values = self[of]
        ax = axes(ax)
        ax.hist(values[np.isfinite(values)], bins=bins)
        ax.set_xlabel(f"{of} [{self.unit(of)}]" if self.unit(of) else of)
        ax.set_ylabel("variants")
        return ax


class ManyPaths:
    """The paths of many variants of a scene along one number: their folds and other events. Arrays have the `shape` of
    the numbers that were given. `curve` follows one of them again, with all its points. It pickles."""

    def __init__(self, scene: Scene, varied: Varied, found: Mapping[str, Any], vary: tuple[str, float, float],
                 options: Mapping[str, Any]) -> None:
        _expect_varied(varied, "ManyPaths objects come from Scene.path_many()")
        self._scene = scene
        self._varied = varied
        self._found = found
        self._vary = vary
        self._options = options
        events = found["events"]
        self._first = np.searchsorted(np.array(events["variant"], dtype=np.int64), np.arange(varied.variants + 1))

    @property
    def shape(self) -> tuple[int, ...]:
        """The shape of the numbers that were given, broadcast."""
        return self._varied.shape

    @property
    def variants(self) -> int:
        """How many variants there are."""
        return self._varied.variants

    @property
    def unit(self) -> str:
        """The unit of the number along which paths were followed, and of the folds."""
        return str(self._found["unit"])

    def __bool__(self) -> bool:
        """All paths were followed to their ends."""
        return all(status == "traced" for status in self._found["status"])

    @property
    def status(self) -> npt.NDArray[np.str_]:
        """How each path ended: ``traced``, ``incomplete``, ``no start``, ``interrupted``, ``not started``."""
        return frozen(np.array(self._found["status"], dtype=str).reshape(self.shape))

    @property
    def points(self) -> npt.NDArray[np.int64]:
        """How many points each path has."""
        return frozen(np.array(self._found["points"], dtype=np.int64).reshape(self.shape))

    @property
    def unproved(self) -> npt.NDArray[np.int64] | None:
        """How many points of each carry no proof although one was tried; None where none was asked for."""
        if not self._options["proof"]:
            return None
        return frozen(np.array(self._found["unproved"], dtype=np.int64).reshape(self.shape))

    @property
    def fold(self) -> Floats:
        """The value of the number at the first fold of each path, in the scene's units; nan where there is none."""
        out = np.full(self.variants, np.nan)
        for variant in range(self.variants):
            folds = self._folds(variant)
            if folds.size:
                out[variant] = folds[0]
        return frozen(out.reshape(self.shape))

    def why(self, variant: Index) -> str:
        """What is to be said of a path, in a sentence."""
        return str(self._found["why"][self._varied.index(variant)])

    def folds(self, variant: Index) -> Floats:
        """The values of the number at the folds of a path, in their order."""
        return self._folds(self._varied.index(variant))

    def _folds(self, at: int) -> Floats:
        events = self._found["events"]
        return np.array([events["value"][k] for k in self._range(at) if events["kind"][k] == "fold"], dtype=np.float64)

    def _range(self, at: int) -> range:
        return range(int(self._first[at]), int(self._first[at + 1]))

    def events(self, variant: Index) -> list[Record]:
        """The events of a path in their order: ``kind`` (fold, branch, stop, slack, flutter, snap, hysteresis end), the
        ``value`` of the number there, its relative ``error``, ``item`` (the stop or spring that comes ``on`` or off),
        ``landing`` (of a snap), and the stability ``before`` and ``after``. What is not known is None."""
        columns = {name: column for name, column in self._found["events"].items() if name != "variant"}
        places = self._range(self._varied.index(variant))
        return [Record({name: _known(column[k]) for name, column in columns.items()}) for k in places]

    def scene(self, variant: Index) -> Scene:
        """The scene of a variant."""
        return self._scene.with_numbers(self._varied.of(self._varied.index(variant)))

    def curve(self, variant: Index) -> Curve:
        """The path of a variant with all its points, as of `Scene.path`; it is followed again."""
        options: dict[str, Any] = {name: self._options[name] for name in ("from_", "follow", "branches")}
        if self._options["proof_seconds"] is not None:
            options["proof_seconds"] = self._options["proof_seconds"]
        return self.scene(variant).path(*self._vary, **options)

    def _summary(self) -> str:
        name, start, end = self._vary
        ends = {status: self._found["status"].count(status) for status in dict.fromkeys(self._found["status"])}
        count = ", ".join(f"{n} {status}" for status, n in ends.items())
        unit = f" {self.unit}" if self.unit else ""
        plural = "path" if self.variants == 1 else "paths"
        text = f"{self.variants} {plural} along {name} from {start:g} to {end:g}{unit}: {count}"
        mean, sigma, least, most, known = _spread(self.fold)
        if known:
            spread = f"mean {mean:.6g}, sigma {sigma:.3g}, from {least:.6g} to {most:.6g}{unit}"
            text += f"; first fold of {known} of them: {spread}"
        return text

    def __repr__(self) -> str:
        return self._summary()

    def _repr_html_(self) -> str:
        from html import escape

        return f"<p>{escape(self._summary())} {_histogram(self.fold)}</p>"

    def to_dict(self) -> dict[str, Any]:
        """All of it in lists, numbers and texts, as for JSON; what is not known is None."""
        return {
            "variants": self.variants,
            "shape": list(self.shape),
            "vary": {"number": self._vary[0], "from": self._vary[1], "to": self._vary[2], "unit": self.unit},
            "numbers": {
                path: {"unit": self._varied.units[path], "values": _listed(array)}
                for path, array in self._varied.values.items()
            },
            "paths": [
                {
                    "status": self._found["status"][at],
                    "why": self._found["why"][at] or None,
                    "points": self._found["points"][at],
                    "unproved": self._found["unproved"][at] if self._options["proof"] else None,
                    "events": [dict(event) for event in self._events_at(at)],
                }
                for at in range(self.variants)
            ],
        }

    def _events_at(self, at: int) -> list[Record]:
        return self.events(tuple(int(k) for k in np.unravel_index(at, self.shape)) if self.shape else ())

    def to_frame(self) -> Any:
        """A pandas DataFrame with a row for each event: ``variant`` (its place in flat arrays), the numbers of the
        variant, ``kind``, ``value``, ``error``, ``landing``, ``item``, ``on``, ``before``, ``after``."""
        pandas = needed("pandas", "python3-pandas", "to_frame()")
        events = self._found["events"]
        at = np.array(events["variant"], dtype=np.int64)
        values = self._varied.values.items()
        columns: dict[str, Any] = {"variant": at}
        columns.update({path: np.broadcast_to(array, self.shape).reshape(-1)[at] for path, array in values})
        columns.update({name: column for name, column in events.items() if name != "variant"})
        frame = pandas.DataFrame(columns)
        frame.attrs["units"] = {"value": self.unit, "landing": self.unit, **self._varied.units}
        return frame


class Batches:
    """What a scene does for many variants of itself."""

    __slots__ = ()

    _core: _poise.Scene

    def solve_many(
        self,
        numbers: Mapping[str, npt.ArrayLike],
        of: str | Sequence[str] = (),
        proved: str | int | None = None,
        proof_seconds: float | None = None,
        jobs: int = 0,
        progress: Callable[[str], object] | None = None,
    ) -> Many:
        """The equilibria of many variants, each the one that `solve` finds for it.

        ``numbers`` are arrays by the names of numbers of the scene, in its units, of one shape or such that NumPy
        broadcasts them to one; float64 in one piece is read where it lies, and the result keeps a copy. ``of`` names
        the quantities wanted (docs/quantities.md). ``proved`` is ``"all"`` for a proof of every variant, or of how
        many, evenly spread; None for none. ``jobs`` threads, 0 for all cores; ``progress`` is called with a text.
        Ctrl-C ends it, with what was solved. That a variant has no equilibrium is no exception: see `Many.solved`,
        `Many.by` and `Many.why`. Raises InputError for unknown names, other shapes, values that a number cannot have.

        >>> import numpy as np, poise
        >>> clamp = poise.load("datasets/toggle_clamp.toml")
        >>> numbers = {"load.P": np.linspace(0, 30, 7), "spring.rubber.stiffness": 400}
        >>> many = clamp.solve_many(numbers, of="force.rubber")
        >>> many.solved.all(), many["force.rubber"].shape, many.unit("force.rubber")
        (True, (7,), 'N')
        """
        varied = Varied("solve_many", self._core, numbers)
        asked = _names("of", of)
        if proof_seconds is not None and proved is None:
            raise _poise.InputError('proof_seconds: expected proved="all" or a number too; without, nothing is proved')
        kept = varied.kept()
        found = _poise.solve_many(
            self._core, varied.flat(), asked, _samples(proved), proof_seconds, _whole("jobs", jobs), progress
        )
        return Many(self._core.title or self._core.name, kept, found, asked, proved is not None)

    def path_many(
        self,
        numbers: Mapping[str, npt.ArrayLike],
        vary: tuple[str, float, float],
        from_: str = "settle",
        follow: str = "unstable",
        branches: bool = False,
        proof: bool = True,
        proof_seconds: float | None = None,
        jobs: int = 0,
        progress: Callable[[str], object] | None = None,
    ) -> ManyPaths:
        """The paths of many variants along one number, ``vary=("load.P", 0, 60)`` in the scene's units, on threads.

        ``numbers`` as of `solve_many`. ``from_``, ``follow``, ``branches`` and ``proof_seconds`` are those of `path`;
        ``proof=False`` leaves points without certificates, which take most of the time. Ctrl-C ends it, with what was
        followed. Raises InputError for bad input; that a path cannot be followed is a status.

        >>> import numpy as np, poise
        >>> clamp = poise.load("datasets/toggle_clamp.toml")
        >>> paths = clamp.path_many({"spring.rubber.stiffness": [300, 400]}, vary=("load.P", 0, 60))
        >>> paths.fold.round(3)
        array([28.094, 37.093])
        """
        varied = Varied("path_many", self._core, numbers)
        name, start, end = _range_of(vary)
        options = {
            "from_": checked_name(from_), "follow": checked_name(follow), "branches": _flag("branches", branches),
            "proof": _flag("proof", proof), "proof_seconds": proof_seconds,
        }
        if proof_seconds is not None and not options["proof"]:
            raise _poise.InputError("proof_seconds: expected none with proof=False, with which nothing is proved")
        path = self._core.path_of(name) if name != "loads" and "." not in name else name
        if path in varied.values:
            raise _poise.InputError(f"path_many: {path} is what vary varies; expected other numbers")
        kept = varied.kept()
        found = _poise.path_many(self._core, varied.flat(), varied.variants, path, start, end, options,
                                 _whole("jobs", jobs), progress)
        scene: Any = self
        return ManyPaths(scene, kept, found, (path, start, end), options)


def _names(what: str, given: Any) -> list[str]:
    try:
        names: list[Any] = [given] if isinstance(given, str) else list(given)
    except TypeError:
        names = [None]
    if not all(isinstance(name, str) for name in names):
        raise _poise.InputError(f"{what}: expected names of quantities, found {_poise.shown(given)}")
    return [checked_text(name) for name in names]


def _samples(proved: Any) -> int:
    if proved is None:
        return 0
    if isinstance(proved, str) and proved == "all":
        return _poise.every_sample
    if isinstance(proved, (int, np.integer)) and not isinstance(proved, bool) and proved > 0:
        return int(proved)
    raise _poise.InputError(f'proved: expected "all", a number of variants, or None, found {_poise.shown(proved)}')


def _whole(what: str, given: Any) -> int:
    if isinstance(given, (int, np.integer)) and not isinstance(given, bool) and abs(int(given)) < 2**31:
        return int(given)
    raise _poise.InputError(f"{what}: expected a whole number, found {_poise.shown(given)}")


def _flag(what: str, given: Any) -> bool:
    if isinstance(given, (bool, np.bool_)):
        return bool(given)
    raise _poise.InputError(f"{what}: expected True or False, found {_poise.shown(given)}")


def _range_of(vary: Any) -> tuple[str, float, float]:
    refuse_mask("vary", vary)
    try:
        name, start, end = vary
        out = (checked_name(name), float(_poise.real_array(start, "vary")), float(_poise.real_array(end, "vary")))
    except (TypeError, ValueError) as error:
        if isinstance(error, _poise.InputError):
            raise
        found = _poise.shown(vary)
        raise _poise.InputError(f'vary: expected a name and a range, ("load.P", 0, 60), found {found}') from None
    if not np.isfinite(out[1:]).all():
        raise _poise.InputError(f"vary: expected finite numbers, found {_poise.shown(vary)}")
    return out
