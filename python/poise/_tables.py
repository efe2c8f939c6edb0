"""Tables and records of what was found: columns as NumPy arrays, members of JSON objects by name."""

from __future__ import annotations

import functools
import importlib
import pathlib
from typing import TYPE_CHECKING, Any, Iterator, Mapping, Sequence, TypeAlias, TypeVar

import numpy as np

from . import _poise

if TYPE_CHECKING:
    import numpy.typing as npt  # takes 3 ms to import

Array: TypeAlias = "npt.NDArray[Any]"
Value = TypeVar("Value", covariant=True)
#: The folder of the scenes and other files that come with the package.
EXAMPLES = pathlib.Path(__file__).with_name("datasets")
#: What the compiled part gives of a column: texts, or numbers and their unit.
Column: TypeAlias = "list[str] | tuple[npt.NDArray[np.float64], str]"


def needed(module: str, package: str, what: str) -> Any:
    """A module that only some calls need. Raises ImportError, which says how to get it."""
    try:
        return importlib.import_module(module)
    except ImportError as error:
        raise ImportError(f"{what} needs {module.split('.')[0]}; install {package}, or by pip") from error


def shown(name: object) -> str:
    """A name as messages have it: on one line, and cut where it is long."""
    text = str(name)
    text = text if text.isprintable() else repr(text)
    return text if len(text) <= 100 else text[:100] + "..."


def unknown(what: str, name: object, known: Sequence[str]) -> _poise.InputError:
    """The error of a name that is none, with the nearest ones."""
    near = _poise.did_you_mean(checked_text(str(name)), list(known))
    return _poise.InputError(f"{shown(name)}: expected {what}{near}")


def write_file(path: pathlib.Path, text: str) -> None:
    """Writes a text as UTF-8. Raises InputError where it cannot."""
    try:
        path.write_text(text, encoding="utf-8")
    except (OSError, ValueError) as error:
        why = error.strerror if isinstance(error, OSError) else "such a name is none of a file"
        raise _poise.InputError(f"{path}: expected a file that can be written: {why}") from error


def checked_text(text: str) -> str:
    """A text that the compiled part can be given. Raises InputError for one with surrogates."""
    try:
        text.encode()
    except UnicodeEncodeError:
        raise _poise.InputError(f"expected a text that UTF-8 can hold, found {text!r:.200}") from None
    return text


def checked_name(name: Any) -> str:
    """A name, which is a text. Raises InputError for anything else."""
    if isinstance(name, str):
        return checked_text(name)
    raise _poise.InputError(f"expected a name in quotes, found {name!r:.200}")


@functools.lru_cache(maxsize=None)
def si_unit(unit: str) -> tuple[str, float]:
    """The SI unit of the same kind and the SI value of one unit: ("N m", 0.001) of "N mm"."""
    name, value = _poise.si_unit(unit)
    return name, value


def refuse_mask(place: str, given: Any, depth: int = 4) -> None:
    """Raises InputError where NumPy masks some of the numbers: what a mask hides would be read as a number."""
    if isinstance(given, dict):
        for name, one in given.items() if depth > 0 else ():
            refuse_mask(name if isinstance(name, str) else place, one, depth - 1)
    elif isinstance(given, (list, tuple)):
        for one in given if depth > 0 else ():
            refuse_mask(place, one, depth - 1)
    elif isinstance(given, np.ma.MaskedArray) and (hidden := int(np.sum(given.mask))):
        numbers = "a number" if given.ndim == 0 else "numbers without a mask"
        raise _poise.InputError(f"{place}: expected {numbers}, found {hidden} of {given.size} masked")


def frozen(array: Array) -> Array:
    """The same array, which cannot be written to from now on."""
    array.flags.writeable = False
    return array


def float_of(value: Any) -> float:
    """A number of JSON; null, which is what has no value, is nan."""
    return float("nan") if value is None else float(value)


class ByName(Mapping[str, Value]):
    """What has parts by name. ``[]`` raises InputError for a name that is none, which Mapping does not expect."""

    def __contains__(self, name: object) -> bool:
        try:
            self[name]  # type: ignore[index]  # what is no text is no name
        except _poise.InputError:
            return False
        return True

    def get(self, name: str, default: Any = None) -> Any:
        """The part of a name, or ``default`` where there is none."""
        try:
            return self[name]
        except _poise.InputError:
            return default


class Table(ByName[Array]):
    """Columns by name. Numbers are arrays of float64 that cannot be written to: where they come from the work itself
    they are views of its memory, not copies, and keep it alive. Texts are arrays of str. What is undefined is nan."""

    def __init__(self, columns: Mapping[str, Column], in_si: bool = False) -> None:
        self._columns = columns
        self._in_si = in_si

    def __getitem__(self, name: str) -> Array:
        column = self._columns.get(checked_name(name))
        if column is None:
            raise unknown("the name of a column", name, list(self._columns))
        if isinstance(column, list):
            return frozen(np.array(column, dtype=str))
        numbers, unit = column
        return frozen(numbers * si_unit(unit)[1]) if self._in_si and si_unit(unit)[1] != 1.0 else numbers

    def __contains__(self, name: object) -> bool:
        return isinstance(name, str) and name in self._columns

    def __iter__(self) -> Iterator[str]:
        return iter(self._columns)

    def __len__(self) -> int:
        return len(self._columns)

    @property
    def rows(self) -> int:
        """How many rows the columns have."""
        for column in self._columns.values():
            return len(column) if isinstance(column, list) else len(column[0])
        return 0

    def unit(self, name: str) -> str:
        """The unit of a column; "" of texts and of numbers without one."""
        column = self._columns.get(name)
        if column is None:
            raise unknown("the name of a column", name, list(self._columns))
        if isinstance(column, list):
            return ""
        return si_unit(column[1])[0] if self._in_si else column[1]

    @property
    def si(self) -> Table:
        """The same in SI units."""
        return Table(self._columns, in_si=True)

    def to_frame(self) -> Any:
        """A pandas DataFrame, a row for each row; ``attrs["units"]`` has the units of its columns."""
        pandas = needed("pandas", "python3-pandas", "to_frame()")
        frame = pandas.DataFrame({name: self[name] for name in self})
        frame.attrs["units"] = {name: self.unit(name) for name in self if self.unit(name)}
        return frame

    def __repr__(self) -> str:
        return f"<{self.rows} rows of {', '.join(self)}>"


class Record(ByName[Any]):
    """An object of JSON (docs/json.md), whose members are attributes too: ``event["kind"]`` is ``event.kind``."""

    def __init__(self, members: Mapping[str, Any]) -> None:
        self._members = members

    def __getitem__(self, name: str) -> Any:
        if checked_name(name) not in self._members:
            raise unknown("a member", name, list(self._members))
        value = self._members[name]
        return Record(value) if isinstance(value, dict) else value

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):  # before there are members, too: pickle asks then
            raise AttributeError(name)
        if name not in self._members:
            raise AttributeError(f"{name}: expected a member{_poise.did_you_mean(name, list(self._members))}")
        return self[name]

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self._members]

    def __iter__(self) -> Iterator[str]:
        return iter(self._members)

    def __len__(self) -> int:
        return len(self._members)

    def to_dict(self) -> dict[str, Any]:
        """The members as in JSON."""
        return dict(self._members)

    def __repr__(self) -> str:
        plain = ((name, value) for name, value in self._members.items() if not isinstance(value, (dict, list)))
        return ", ".join(f"{name}={value!r}" for name, value in plain)


class Matrix(np.ndarray[Any, np.dtype[np.float64]]):
    """A square matrix whose rows and columns have names: ``matrix["mP", "k"]``; a NumPy array in all else.

    ``names`` are those of its rows, which are those of its columns; parts are plain arrays.
    """

    names: tuple[str, ...]

    def __new__(cls, values: Any, names: Sequence[str]) -> Matrix:
        out = np.asarray(values, dtype=np.float64).reshape(len(names), len(names)).view(cls)
        out.names = tuple(names)
        return out

    def __array_finalize__(self, source: Any) -> None:
        names = getattr(source, "names", ())
        self.names = names if self.shape == (len(names), len(names)) else ()

    def _place(self, name: Any) -> Any:
        if not isinstance(name, str):
            return name
        if name not in self.names:
            raise unknown("the name of an estimate", name, self.names)
        return self.names.index(name)

    def __getitem__(self, key: Any) -> Any:
        place = tuple(self._place(part) for part in key) if isinstance(key, tuple) else self._place(key)
        try:
            found = super().__getitem__(place)
            # A part, or one in another order, has not these names.
            return np.asarray(found) if isinstance(found, np.ndarray) else found
        except (ValueError, IndexError) as error:
            raise _poise.InputError(f"expected names or indices of estimates: {error}") from error

    def __reduce__(self) -> Any:
        return (Matrix, (np.asarray(self), self.names))

    def to_frame(self) -> Any:
        """A pandas DataFrame with the names of its rows and columns."""
        pandas = needed("pandas", "python3-pandas", "to_frame()")
        return pandas.DataFrame(np.asarray(self), index=list(self.names), columns=list(self.names))
