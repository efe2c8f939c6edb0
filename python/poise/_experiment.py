"""Experiments: what was measured on a mechanism, and which of its numbers are to be identified."""

from __future__ import annotations

import contextlib
import os
import pathlib
import tempfile
import tomllib
from typing import Any, Iterator, Mapping, Sequence, Union

import numpy as np
import numpy.typing as npt

from . import _commands, _poise
from ._found import Fit, Found
from ._run import Path, is_row, shown
from ._scene import Scene
from ._tables import checked_text, refuse_mask, unknown, write_file
from ._toml import toml_text

Floats = npt.NDArray[np.float64]
#: Times of a run in s, shape (n,), ascending; or by sensor, where sensors have times of their own.
Time = Union[npt.ArrayLike, Mapping[str, npt.ArrayLike]]

#: Keys of a run that say how it is simulated, or from which file its readings come.
_REPLACED = ("duration", "rate", "seed", "data", "time", "time_factor", "split", "segments")


class Experiment:
    """An experiment, as a file describes it (docs/experiment-files.md), with readings from arrays where they are given.

    ``Experiment("lift_experiment.toml")`` is that file. ``Experiment("lift_experiment.toml", time=t, readings={"angle":
    y})`` has these readings in place of the runs' own; times are in s, readings are what the column of a data file
    would have, before ``zero``, ``factor`` and ``delay`` of the sensor. Of several runs ``time`` and each of the
    readings are lists of arrays, one for each run of the file, or for copies of its only one; None in such a list is a
    sensor that was not read. ``time={"angle": t1, "force": t2}`` is for sensors with times of their own. NaN is a gap,
    of a sensor with ``gaps = true``. ``inputs={"load.motor": tau}`` are loads and drives that were read at these times.

    ``Experiment(scene, sensors=..., unknowns=...)`` is written in Python altogether, with the keys of experiment files:
    sensors and unknowns by name and path, ``sensors={"angle": {"read": "angle.obd", "noise": 1e-4}}``,
    ``unknowns={"body.lump.mass": {"start": 40}}``, ``known`` likewise; ``runs`` are dictionaries of keys, and so are
    ``statics``, readings at rest: ``statics=[{"inputs": {"load.W": w}, "readings": {"angle": y}}]`` with lists or
    arrays. Without ``runs`` and arrays these are all that is read.

    >>> import numpy as np, poise
    >>> scene = poise.load("datasets/lift.toml")
    >>> swing = scene.motion(2, release={"obd": 0.005}, rate=200)
    >>> noise = 1e-4 * np.random.default_rng(1).standard_normal(len(swing))
    >>> experiment = poise.Experiment(
    ...     scene, sensors={"angle": {"read": "angle.obd", "noise": 1e-4}}, unknowns=["spring.oil.stiffness"],
    ...     time=swing.time, readings={"angle": swing["angle.obd"] + noise})
    >>> fit = experiment.identify()
    >>> bool(fit), abs(float(fit["spring.oil.stiffness"]) / scene.numbers["spring.oil.stiffness"] - 1) < 0.01
    (True, True)

    Raises InputError for readings that are no numbers, have another shape than the times or a name that is no sensor's,
    and for times that do not ascend; what the keys say is checked by the commands.
    """

    def __init__(self, source: Path | Scene, *, time: Time | Sequence[Time] | None = None,
                 readings: Mapping[str, Any] | None = None, inputs: Mapping[str, Any] | None = None,
                 sensors: Mapping[str, Any] | None = None, unknowns: Mapping[str, Any] | Sequence[Any] | None = None,
                 known: Mapping[str, Any] | None = None, runs: Sequence[Mapping[str, Any]] | None = None,
                 statics: Sequence[Mapping[str, Any]] | None = None, title: str | None = None,
                 loss: str | None = None) -> None:
        self._file: str | None = None
        self._texts: dict[str, str] = {}
        built = {"sensors": sensors, "unknowns": unknowns, "known": known, "runs": runs, "statics": statics,
                 "title": title, "loss": loss}
        if isinstance(source, Scene):
            self._name = "experiment.toml"
            document = self._built(source, sensors or {}, unknowns or {}, known or {}, title, loss)
            if statics is not None:
                document["static"] = [_at_rest(_dictionary("statics", one)) for one in statics]
            if runs is not None or statics is None or time is not None:
                document["run"] = [{}] if runs is None else [dict(_dictionary("runs", run)) for run in runs]
        else:
            given = [name for name, value in built.items() if value is not None]
            if given:
                raise _poise.InputError(f"{given[0]}: expected a Scene in place of the experiment file, "
                                        f"which has its own, found {shown(source)}")
            self._file = _file_name(source)
            if time is None and readings is None and inputs is None:
                return
            self._name = os.path.basename(self._file)
            document = _read(self._file)
        if time is not None or readings is not None or inputs is not None:
            document["run"] = self._measured(document, time, readings, inputs or {})
        self._texts[self._name] = toml_text(document)
        self._file = None

    # How it is written.

    def _built(self, scene: Scene, sensors: Mapping[str, Any], unknowns: Mapping[str, Any] | Sequence[Any],
               known: Mapping[str, Any], title: str | None, loss: str | None) -> dict[str, Any]:
        document: dict[str, Any] = {"title": scene.title if title is None else title}
        if loss is not None:
            document["loss"] = loss
        core = scene._core
        if _is_as_read(core):
            document["scene"] = os.path.abspath(core.name)
            if core.changes:
                document["set"] = dict(core.changes)
        else:
            self._texts["scene.toml"] = scene.toml
            document["scene"] = "scene.toml"
        document["sensor"] = [{"name": name, **_keys("sensors", name, keys, "read")}
                              for name, keys in _dictionary("sensors", sensors).items()]
        listed = unknowns if isinstance(unknowns, Mapping) else {path: {} for path in _listed("unknowns", unknowns)}
        document["unknown"] = [{"path": path, **_keys("unknowns", path, keys, "start")}
                               for path, keys in listed.items()]
        if known:
            document["known"] = [{"path": path, **_keys("known", path, keys, "deviation")}
                                 for path, keys in _dictionary("known", known).items()]
        return document

    def _measured(self, document: Mapping[str, Any], time: Any, readings: Any, inputs: Any) -> list[dict[str, Any]]:
        """The runs with arrays in place of what they had."""
        if time is None or readings is None:
            missing = "time" if time is None else "readings"
            raise _poise.InputError(f"{missing}: expected arrays, as there are of time, readings or inputs; found none")
        columns = _columns_of(document)
        _check_names("readings", _dictionary("readings", readings), list(columns))
        times = list(time) if _is_several(time) else [time]
        runs = [dict(run) for run in document.get("run", [])]
        if not runs:
            raise _poise.InputError(f"time: expected an experiment with a run in motion, {self._name} has readings at "
                                    "rest alone; give them by statics")
        if len(runs) == 1 and len(times) > 1:
            begin = runs[0].get("name", "run")
            runs = [{**runs[0], "name": f"{begin} {k + 1}"} for k in range(len(times))]
        if len(times) != len(runs):
            raise _poise.InputError(f"time: expected {len(runs)} arrays, one for each run of {self._name}, "
                                    f"found {len(times)}")
        gaps = {name for name, sensor in columns.items() if sensor.get("gaps") is True}
        for k, run in enumerate(runs):
            read = {name: one for name, one in _of_run("readings", readings, k, len(times), _is_several(time)).items()
                    if one is not None}
            driven = _of_run("inputs", _dictionary("inputs", inputs), k, len(times), _is_several(time))
            self._replace(run, k, times[k], read, driven, columns, gaps, "" if len(times) == 1 else f"[{k}]")
        return runs

    def _replace(self, run: dict[str, Any], k: int, time: Any, read: Mapping[str, Any], driven: Mapping[str, Any],
                 columns: Mapping[str, Mapping[str, Any]], gaps: set[str], index: str) -> None:
        """Writes the data files of a run, and names them in it. ``index`` is that of the run, for messages."""
        in_seconds = run.get("time_factor") == 1
        for key in _REPLACED:
            run.pop(key, None)
        if not read:
            raise _poise.InputError(f"readings{index}: expected an array of at least one sensor, found none")
        if set(read) != set(columns) or "sensors" in run:
            run["sensors"] = [name for name in columns if name in read]
        names = {name: str(sensor.get("column", name)) for name, sensor in columns.items()}
        clock = "time"
        while clock in names.values():
            clock += "_"
        files = []
        if isinstance(time, Mapping):
            _check_names("time" + index, time, list(read))
            for name in read:
                if name not in time:
                    raise _poise.InputError(f"time{index}: expected times of the sensor \"{name}\" too, found none")
            groups = [(f'time{index}["{name}"]', time[name], [name]) for name in read]
        else:
            groups = [(f"time{index}", time, list(read))]
        for number, (place, one, sensors) in enumerate(groups):
            times = _times(place, one)
            table = {clock: times}
            for name in sensors:
                table[names[name]] = _numbers(f'readings["{name}"]{index}', read[name], times.shape, name in gaps)
            files.append(f"run_{k + 1}.csv" if len(groups) == 1 else f"run_{k + 1}_{number + 1}.csv")
            self._texts[files[-1]] = _csv(table)
        run["data"] = files[0] if len(files) == 1 else files
        run["time"] = clock
        if in_seconds:
            run["time_factor"] = 1
        self._replace_inputs(run, k, time, driven, index)

    def _replace_inputs(self, run: dict[str, Any], k: int, time: Any, driven: Mapping[str, Any], index: str) -> None:
        entries: dict[str, dict[str, Any]] = {
            path: {"column": entry} if isinstance(entry, str) else dict(entry)
            for path, entry in run.get("inputs", {}).items()}
        for path, entry in entries.items():
            if "file" not in entry and path not in driven:
                raise _poise.InputError(f"inputs{index}: expected an array of \"{path}\", which the run reads from its "
                                        f"data file, found none")
        if driven:
            times = _times(f"time{index}", time)
            for path, values in driven.items():
                entry = entries.setdefault(path, {})
                entry.pop("time_factor", None)
                entry.update(column=path, time="time", file=f"inputs_{k + 1}.csv")
            self._texts[f"inputs_{k + 1}.csv"] = _csv({"time": times, **{
                path: _numbers(f'inputs["{path}"]{index}', values, times.shape, entries[path].get("gaps") is True)
                for path, values in driven.items()}})
        if entries:
            run["inputs"] = entries

    # What it is.

    @property
    def stays(self) -> bool:
        """Whether it is a file, and not written for each command."""
        return self._file is not None

    @contextlib.contextmanager
    def on_disk(self) -> Iterator[str]:
        """The name of its file, which exists from entering to leaving."""
        if self._file is not None:
            yield self._file
            return
        with tempfile.TemporaryDirectory(prefix="poise-") as folder:
            self.save(folder)
            yield os.path.join(folder, self._name)

    @property
    def toml(self) -> str:
        """The text of its file. Raises InputError where that cannot be read."""
        return self._texts[self._name] if self._file is None else _text(self._file)

    def save(self, folder: Path) -> None:
        """Writes it into a folder: the experiment, and a data file for each run. Raises InputError where that fails."""
        texts = self._texts if self._file is None else {os.path.basename(self._file): self.toml}
        for name, text in texts.items():
            write_file(pathlib.Path(_file_name(folder), name), text)

    def __repr__(self) -> str:
        return f"<Experiment {self._file or self._name}>"

    # What can be asked of it; the options are those of the functions of the same names.

    def identify(self, **options: Any) -> Fit:
        """poise.identify(self): the numbers fitted to the readings, with standard errors."""
        return _commands.identify(self, **options)

    def validate(self, with_: Path | Found, **options: Any) -> Found:
        """poise.validate(self, fit): how well a fit predicts these readings."""
        return _commands.validate(self, with_, **options)

    def identifiability(self, **options: Any) -> Found:
        """poise.identifiability(self): which numbers it determines, before any fit."""
        return _commands.identifiability(self, **options)

    def plan(self, **options: Any) -> Found:
        """poise.plan(self): the runs that determine its numbers best."""
        return _commands.plan(self, **options)

    def montecarlo(self, **options: Any) -> Found:
        """poise.montecarlo(self): simulated and fitted many times."""
        return _commands.montecarlo(self, **options)


def _file_name(file: Any) -> str:
    try:
        name = os.fsdecode(file)
    except TypeError:
        name = ""
    if not name or "\0" in name:
        raise _poise.InputError(f"Experiment: expected the name of a file or a Scene, found {shown(file)}")
    return checked_text(name)


def _text(file: str) -> str:
    try:
        return pathlib.Path(file).read_text(encoding="utf-8")
    except OSError as error:
        raise _poise.InputError(f"{file}: cannot be read: {error.strerror}; check the path") from error
    except UnicodeDecodeError as error:
        raise _poise.InputError(f"{file}: expected a text in UTF-8") from error


def _read(file: str) -> dict[str, Any]:
    """The document of an experiment file, in which files have absolute names. Raises InputError."""
    try:
        document = tomllib.loads(_text(file))
    except tomllib.TOMLDecodeError as error:
        raise _poise.InputError(f"{file}: {error}") from error
    if "experiments" in document:
        raise _poise.InputError(f"{file}: arrays belong to one of its experiments; expected the file of that")
    for key in ("sensor", "run"):
        if not isinstance(document.get(key), list) or not all(isinstance(one, dict) for one in document[key]):
            raise _poise.InputError(f"{file}: expected at least one [[{key}]]")
    folder = os.path.dirname(os.path.abspath(file))
    if isinstance(document.get("scene"), str):
        document["scene"] = os.path.join(folder, document["scene"])
    for run in document["run"]:
        if not isinstance(run.get("inputs", {}), dict):
            raise _poise.InputError(f"{file}: inputs: expected a table")
        for entry in run.get("inputs", {}).values():
            if isinstance(entry, dict) and isinstance(entry.get("file"), str):
                entry["file"] = os.path.join(folder, entry["file"])
    return document


def _is_as_read(core: _poise.Scene) -> bool:
    """Whether the scene is a file that still has the same text."""
    try:
        return pathlib.Path(core.name).read_text(encoding="utf-8") == core.text
    except (OSError, UnicodeDecodeError, ValueError):
        return False


def _columns_of(document: Mapping[str, Any]) -> dict[str, Mapping[str, Any]]:
    """The sensors by name."""
    return {str(sensor.get("name", f"sensor {k + 1}")): sensor for k, sensor in enumerate(document["sensor"])}


def _at_rest(keys: Mapping[str, Any]) -> dict[str, Any]:
    """A table [[static]] whose inputs and readings may be arrays."""
    out = dict(keys)
    for name in ("inputs", "readings"):
        if name in out:
            out[name] = {key: _numbers_or_column(f"statics.{name}.{key}", column)
                         for key, column in _dictionary(f"statics.{name}", out[name]).items()}
    return out


def _numbers_or_column(place: str, given: Any) -> Any:
    if isinstance(given, str):
        return given
    try:
        return np.atleast_1d(np.asarray(given, dtype=np.float64)).tolist()
    except (TypeError, ValueError):
        raise _poise.InputError(f"{place}: expected numbers, or the name of a column, found {shown(given)}") from None


def _dictionary(place: str, given: Any) -> Mapping[str, Any]:
    if not isinstance(given, Mapping) or not all(isinstance(name, str) for name in given):
        raise _poise.InputError(f"{place}: expected a dictionary with names, found {shown(given)}")
    return given


def _listed(place: str, given: Any) -> list[str]:
    if isinstance(given, str) or not is_row(given) or not all(isinstance(one, str) for one in given):
        raise _poise.InputError(f"{place}: expected a dictionary or a list of paths, found {shown(given)}")
    return list(given)


def _keys(place: str, name: str, keys: Any, short: str) -> Mapping[str, Any]:
    """The keys of a sensor or number; what is no dictionary is the value of the key ``short``."""
    if isinstance(keys, Mapping):
        return _dictionary(f'{place}["{name}"]', keys)
    return {short: keys}


def _check_names(place: str, given: Mapping[str, Any], sensors: list[str]) -> None:
    for name in given:
        if name not in sensors:
            raise unknown(f"{place} by the name of a sensor", name, sensors)


def _is_several(time: Any) -> bool:
    """Whether these are the times of several runs: a list of arrays."""
    return isinstance(time, (list, tuple)) and len(time) > 0 and (is_row(time[0]) or isinstance(time[0], Mapping))


def _of_run(place: str, given: Mapping[str, Any], k: int, count: int, several: bool) -> dict[str, Any]:
    """What the run k has: that of a list, where there are several."""
    if not several:
        return dict(given)
    for name, value in given.items():
        if not isinstance(value, (list, tuple)) or len(value) != count:
            raise _poise.InputError(f'{place}["{name}"]: expected a list of {count} arrays, one for each run, '
                                    f"found {_kind(value)}")
    return {name: value[k] for name, value in given.items() if value[k] is not None}


def _kind(value: Any) -> str:
    if getattr(value, "shape", None) is not None:
        return f"shape {value.shape}"
    return f"a list of {len(value)}" if isinstance(value, (list, tuple)) else shown(value)


def _array(place: str, value: Any) -> Floats:
    refuse_mask(place, value)
    try:
        if np.iscomplexobj(value):
            raise TypeError
        out = np.asarray(value, dtype=np.float64)
    except (TypeError, ValueError):
        raise _poise.InputError(f"{place}: expected an array of numbers, found {shown(value)}") from None
    if out.ndim != 1:
        raise _poise.InputError(f"{place}: expected an array of one dimension, found shape {out.shape}")
    return out


def _numbers(place: str, value: Any, shape: tuple[int, ...], gaps: bool) -> Floats:
    out = _array(place, value)
    if out.shape != shape:
        raise _poise.InputError(f"{place}: expected shape {shape}, that of its times, found {out.shape}")
    wrong = np.flatnonzero(np.isinf(out) if gaps else ~np.isfinite(out))
    if wrong.size > 0:
        fix = "" if gaps else "; leave that time out, or give the sensor gaps = true"
        raise _poise.InputError(f"{place}: expected finite numbers, found {out[wrong[0]]} at index {wrong[0]}{fix}")
    return out


def _times(place: str, value: Any) -> Floats:
    out = _array(place, value)
    if out.size < 3:
        raise _poise.InputError(f"{place}: expected at least 3 times, found {out.size}")
    out = _numbers(place, out, out.shape, True)
    # A time that is not a number is neither before nor after another.
    wrong = np.flatnonzero(~(np.diff(out) > 0))
    if wrong.size > 0:
        k = int(wrong[0])
        raise _poise.InputError(f"{place}: expected ascending times, found {float(out[k + 1])} after {float(out[k])} "
                                f"at index {k + 1}")
    return out


def _csv(columns: Mapping[str, Floats]) -> str:
    """Columns as CSV, with the digits from which the same doubles are read; NaN is a gap."""
    quoted = ('"' + name.replace('"', '""') + '"' for name in columns)
    words = [["" if value != value else repr(value) for value in column.tolist()] for column in columns.values()]
    return ",".join(quoted) + "\n" + "".join(",".join(row) + "\n" for row in zip(*words))
