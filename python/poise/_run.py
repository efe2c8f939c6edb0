"""How a command of ``poise`` is called: Python's values as the words of the command line.

The rules, which ``python/generate_commands.py`` follows too:

- a command that reads a scene is a method of Scene, every other one a function of the module; ``solve`` and ``view``
  are written by hand;
- ``--proof-seconds`` is ``proof_seconds``. A name has an underscore at its end where Python has that word for itself
  (``from_``, ``for_``, ``with_``, and the command ``import_``), and where the file that is read has that name
  (``experiment_`` of plan);
- options that say where the result goes, ``--json`` to ``--html``, ``--quiet`` and ``--verbose``, are left out: a
  result has ``save()`` and ``text()``;
- a range, ``--vary load.P=0..60``, may be given by the first three arguments, ``"load.P", 0, 60``.

Messages name options as the command line does.
"""

from __future__ import annotations

import contextlib
import functools
import itertools
import keyword
import os
import pathlib
import tempfile
from typing import Any, Callable, ContextManager, Iterable, Mapping, Protocol, Sequence, SupportsFloat, TypeVar, Union
from typing import runtime_checkable

from . import _poise
from ._found import Call, Found
from ._tables import checked_text, refuse_mask
from ._toml import number_text, toml_text

#: Called with a sentence on what is being done, ten times a second at most, by any thread. An exception that it raises
#: stops the work, and is then raised by the call.
Progress = Callable[[str], object]
Number = SupportsFloat
#: A name, or several.
Words = Union[str, Sequence[str]]
#: Numbers by name, {"load.P": 30}; or as the command line has them, "load.P=30".
Settings = Union[str, Sequence[str], Mapping[str, Number]]
#: Ranges by name, {"crank": (0, 360)}, of which {"crank": 30} is one value and {"crank": None} the one that there is;
#: or as the command line has them, "crank=0..360".
Ranges = Union[str, Sequence[str], Mapping[str, Any]]
#: Changes of a scene by label, {"soft": {"spring.S.stiffness": 2}}; or "soft: spring.S.stiffness=2".
Variants = Union[str, Sequence[str], Mapping[str, Mapping[str, Number]]]
#: Numbers in a row, [1, 2.5, 5], or one; or "1,2.5,5".
Numbers = Union[str, Number, Sequence[Number], "Iterable[Number]"]
Path = Union[str, "os.PathLike[str]"]


@runtime_checkable
class OnDisk(Protocol):
    """What is a file for as long as a command reads it."""

    @property
    def stays(self) -> bool:
        """Whether the file is there before and afterwards, too."""

    def on_disk(self) -> ContextManager[str]:
        """The name of the file, from entering to leaving."""


#: An experiment file, or a poise.Experiment.
ExperimentFile = Union[Path, OnDisk]

#: These make their pictures at once, because to make the call again for them would take as long as the first time.
LONG_COMMANDS = frozenset(("identify", "validate", "montecarlo", "tolerance", "design", "equilibria", "stress",
                           "compare", "plan", "identifiability", "motion"))
#: Where the result goes.
LEFT_OUT_OPTIONS = ("--json", "--csv", "--markdown", "--svg", "--html", "--quiet", "--verbose")

#: Commands that have another name in Python: `Scene.equations` are those of equilibrium.
NAMES_IN_PYTHON = {"equations": "equations_of_motion"}

#: So many numbers in a row at most, for there are iterables without an end.
MOST_NUMBERS = 100_000

Kind = TypeVar("Kind", bound=Found)


def run(kind: type[Kind], command: str, scene: _poise.Scene | None, given: Mapping[str, Any],
        ranged: tuple[str, Any, Any, Any] | None, progress: Progress | None) -> Kind:
    """Calls a command. ``given`` has values by the names of options, None for those that are not given; ``ranged`` is
    an option with name, low and high end of its range. Raises InputError."""
    if progress is not None and not callable(progress):
        raise _poise.InputError(f"progress: expected a function that takes a text, found {shown(progress)}")
    with contextlib.ExitStack() as held:
        files = _Files(held)
        options: list[tuple[str, str]] = []
        for option in _options_of(command):
            name = option["name"]
            if ranged is not None and ranged[0] == name and any(part is not None for part in ranged[1:]):
                options.append((name, checked_text(_range_word(*ranged))))
            if given.get(name) is not None:
                options += [(name, checked_text(word)) for word in _words_of(option, given[name], files)]
        _check_required(command, scene is not None, options)
        if scene is not None:
            options = [(name, _full_range(scene, word) if name == "--vary" else word) for name, word in options]
            # A number that this call sets or varies is not what the scene was given.
            own = {word.partition("=")[0] for name, word in options if name in ("--set", "--vary")}
            options = [("--set", one) for one in scene.settings if one.partition("=")[0] not in own] + options
        # Files that are gone afterwards can be read but once.
        at_once = command in LONG_COMMANDS or files.used
        try:
            core = _poise.call(command, options, scene, at_once, progress)
        except _poise.InputError as error:
            raise _poise.InputError(files.without_folders(str(error))) from None
    found = kind(core, None if files.used else Call(command, options, scene))
    if at_once or core.interrupted:
        found._pictured = core
    return found


@functools.lru_cache(maxsize=None)
def _options_of(command: str) -> list[_poise._Option]:
    for entry in _poise.commands():
        if entry["name"] == command:
            return [option for option in entry["options"] if option["name"] not in LEFT_OUT_OPTIONS]
    raise KeyError(command)


def call_of(command: str) -> str:
    """The name of a command in Python."""
    return NAMES_IN_PYTHON.get(command, command + "_" if keyword.iskeyword(command) else command)


def parameter_of(option: _poise._Option) -> str:
    """The name of an option in Python."""
    name = option["name"].lstrip("-").lower().replace("-", "_")
    return name + "_" if keyword.iskeyword(name) else name


def _check_required(command: str, of_scene: bool, options: Sequence[tuple[str, str]]) -> None:
    """Raises InputError that names arguments which are missing."""
    given = {name for name, _ in options}
    missing = [option for option in _options_of(command)
               if option["required"] and option["name"] not in given and option["name"] != "SCENE"]
    if missing:
        names = " and ".join("name, low, high (or vary)" if option["name"] == "--vary" else parameter_of(option)
                             for option in missing)
        place = f"poise.Scene.{command}" if of_scene else f"poise.{command}"
        raise _poise.InputError(f"{command}: expected {names}, found none; see help({place})")


def _full_range(scene: _poise.Scene, word: str) -> str:
    """A range whose number has its path in place of the end of that; what can be driven is left as it is."""
    name, equals, ends = word.partition("=")
    name = name.strip()
    if name == "loads" or {name, f"angle.{name}", f"travel.{name}"} & set(scene.quantities):
        return word
    try:
        return scene.path_of(name) + equals + ends
    except _poise.InputError:
        return word  # the command says what is wrong with it


class _Files:
    """Files that a command reads and that exist only while it does."""

    def __init__(self, held: contextlib.ExitStack) -> None:
        self._held = held
        self._folders: list[str] = []

    @property
    def used(self) -> bool:
        return bool(self._folders)

    def hold(self, experiment: OnDisk) -> str:
        file = self._held.enter_context(experiment.on_disk())
        if not experiment.stays:
            self._folders.append(os.path.dirname(file))
        return file

    def write(self, name: str, text: str) -> str:
        folder = self._held.enter_context(tempfile.TemporaryDirectory(prefix="poise-"))
        self._folders.append(folder)
        file = pathlib.Path(folder, name)
        file.write_text(text, encoding="utf-8")
        return str(file)

    def without_folders(self, message: str) -> str:
        """A message in which such files have their names alone."""
        for folder in self._folders:
            message = message.replace(folder + os.sep, "")
        return message


def shown(value: Any) -> str:
    """What Python shows of an object, for messages: one line of at most 200 characters."""
    try:
        out = repr(value)
    except Exception:  # noqa: BLE001 -- whatever the object does
        return "something that cannot be shown"
    out = " ".join(out.split())
    return out if len(out) <= 200 else out[:200] + "..."


def _number_word(place: str, value: Any) -> str:
    """A number, written so that the same double is read again."""
    refuse_mask(place, value)
    if isinstance(value, (str, bytes)) or type(value).__name__ in ("bool", "bool_"):
        raise _poise.InputError(f"{place}: expected a number, found {shown(value)}")
    text = number_text(value)
    if text is None:
        raise _poise.InputError(f"{place}: expected a number, found {shown(value)}")
    return text


def _text_word(place: str, value: Any) -> str:
    if isinstance(value, str):
        return value
    raise _poise.InputError(f"{place}: expected a text, found {shown(value)}")


def _file_word(place: str, value: Any) -> str:
    try:
        name = os.fsdecode(value)
    except TypeError:
        name = ""
    if "\0" in name or not name:
        raise _poise.InputError(f"{place}: expected the name of a file, found {shown(value)}")
    return name


def _ends(place: str, value: Any) -> tuple[Any, Any]:
    try:
        low, high = value
    except (TypeError, ValueError):
        raise _poise.InputError(f"{place}: expected a range (low, high), found {shown(value)}") from None
    return low, high


def _range_word(option: str, name: Any, low: Any, high: Any) -> str:
    if name is None or low is None and high is not None:
        raise _poise.InputError(f"{option}: expected a name with the low and the high end of its range, "
                                f"found {shown((name, low, high))}")
    word = _text_word(option, name)
    place = f"{option}: {word}"
    if high is not None:
        return f"{word}={_number_word(place, low)}..{_number_word(place, high)}"
    return word if low is None else f"{word}={_number_word(place, low)}"


def is_row(value: Any) -> bool:
    """Whether it has members: a list, a tuple, an array."""
    return isinstance(value, Sequence) or getattr(value, "ndim", 0) > 0


def _row_of(option: str, value: Any) -> list[Any]:
    """The members of what is a row of numbers, or the only one."""
    if isinstance(value, (bytes, Mapping)) or getattr(value, "ndim", 1) == 0 or not isinstance(value, Iterable):
        return [value]
    out = list(itertools.islice(value, MOST_NUMBERS + 1))
    if len(out) > MOST_NUMBERS:
        raise _poise.InputError(f"{option}: expected at most {MOST_NUMBERS} numbers, found {shown(value)}")
    return out


def _range_of(option: str, name: Any, value: Any) -> str:
    if is_row(value) and not isinstance(value, str):
        return _range_word(option, name, *_ends(f"{option}: {shown(name)}", value))
    return _range_word(option, name, value, None)


def _setting_of(option: str, name: Any, value: Any, between: str) -> str:
    return f"{_text_word(option, name)}{between}{_number_word(f'{option}: {name}', value)}"


def _variant_of(option: str, label: Any, settings: Any) -> str:
    if not isinstance(settings, Mapping):
        raise _poise.InputError(f"{option}: expected a dictionary of numbers for {shown(label)}, "
                                f"found {shown(settings)}")
    return f"{_text_word(option, label)}: " + ", ".join(
        _setting_of(option, name, value, "=") for name, value in settings.items())


#: What a dictionary is for an option, by what the help calls its value.
_OF_DICTIONARY: dict[str, Callable[[str, Any, Any], str]] = {
    "NAME=FROM..TO": _range_of,
    "NAME[=FROM..TO]": _range_of,
    "NAME[=RANGE]": _range_of,
    "NAME[=VALUE]": _range_of,
    "PATH=NUMBER": lambda option, name, value: _setting_of(option, name, value, "="),
    "NAME=NUMBER": lambda option, name, value: _setting_of(option, name, value, "="),
    '"Q = VALUE"': lambda option, name, value: _setting_of(option, name, value, " = "),
    "LABEL: SETTINGS": _variant_of,
}


def _given_file(option: str, value: Any, files: _Files) -> str:
    """A file, or what is written to one: a dictionary of tolerances, a fit, a motion, an experiment."""
    if isinstance(value, Mapping) and option == "--tolerances":
        return files.write("tolerances.toml", toml_text({"tolerances": value}))
    if isinstance(value, Found) and option == "--with":
        return files.write("fit.json", value.json())
    if isinstance(value, Found) and option == "--motion":
        return files.write("motion.csv", value.csv)
    if option == "EXPERIMENT" and isinstance(value, OnDisk):
        return files.hold(value)
    return _file_word(option, value)


def _words_of(option: _poise._Option, value: Any, files: _Files) -> list[str]:
    """The words of an option, one for each time that it is given."""
    name, kind, meta = option["name"], option["kind"], option["value"]
    if kind == "flag":
        if type(value).__name__ not in ("bool", "bool_"):
            raise _poise.InputError(f"{name}: expected True or False, found {shown(value)}")
        return [""] if value else []
    if kind in ("number", "whole number"):
        return [_number_word(name, value)]
    if isinstance(value, Mapping) and meta in _OF_DICTIONARY:
        return [_OF_DICTIONARY[meta](name, key, one) for key, one in value.items()]
    if name in ("EXPERIMENT", "DESIGN", "FILE") or kind == "text" and meta in ("FILE", "DIR") or meta == "OTHER":
        several = kind == "list" and isinstance(value, (list, tuple))
        return [_given_file(name, one, files) for one in (value if several else [value])]
    if kind == "list":
        return [_text_word(name, one) for one in ([value] if not is_row(value) or isinstance(value, str) else value)]
    if meta in ("NUMBERS", "RANGE") and not isinstance(value, str):
        return [",".join(_number_word(name, one) for one in _row_of(name, value))]
    if meta == "NAMES" and isinstance(value, (list, tuple)):
        return [",".join(_text_word(name, one) for one in value)]
    return [_text_word(name, value)]
