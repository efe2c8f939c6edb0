"""Calls everything public of the module with random arguments, most of them wrong.

    python3 misuse.py SEED COUNT LOG

Writes each call into LOG before it is made, so that the last line names the call that ended the process, and prints
what was neither a result, nor poise.InputError with one short line, nor a TypeError. An exception that an argument
itself raises is its user's. What takes long is interrupted, as by Ctrl-C, and what does not end then ends the process.
"""

from __future__ import annotations

import collections
import faulthandler
import fractions
import decimal
import inspect
import io
import json
import os
import pathlib
import random
import signal
import sys
import threading
import traceback
import types
import warnings

import matplotlib.pyplot  # noqa: F401 -- not for the first time in a call, which is interrupted
import numpy as np
import pandas  # noqa: F401
import poise

SECONDS = 1.0  # before a call is interrupted
MOST_SECONDS = 120.0  # before it has hung
LONGEST_MESSAGE = 1000  # bytes

# Opens a browser, or has a server that lives on.
LEFT_OUT = {"view"}
SPECIAL = {"__getitem__", "__contains__", "__call__", "__eq__", "__iter__", "__len__", "__copy__", "__reduce__"}


class Own(Exception):
    """What arguments raise."""


def raising(*names):
    """An object whose methods of these names raise."""

    def method(self, *arguments, **options):
        raise Own("an argument's own error")

    return type("Raising", (), {name: method for name in names})()


def returning(name, value):
    """An object whose method of this name returns a value that it should not."""
    return type("Returning", (), {name: lambda self, *arguments: value})()


def recursive_list():
    out = [1.0]
    out.append(out)
    return out


def recursive_dict():
    out = {"load.P": 1.0}
    out["self"] = out
    return out


def closed_file():
    file = io.StringIO("text")
    file.close()
    return file


def read_only():
    out = np.arange(4.0)
    out.flags.writeable = False
    return out


WRONG = [
    lambda r: None,
    lambda r: r.choice([True, False]),
    lambda r: r.choice([0, -1, 1, 7, 2**31, -(2**31) - 1, 2**63, 2**64, -(2**63) - 1, 10**400, -(10**400)]),
    lambda r: r.choice([float("nan"), float("inf"), -float("inf"), 1e308, -1e308, 5e-324, -0.0, 0.5, 1e18]),
    lambda r: r.choice([1j, decimal.Decimal("NaN"), fractions.Fraction(1, 3), decimal.Decimal("1e999")]),
    lambda r: r.choice([np.float32(1), np.float64("nan"), np.int8(-3), np.uint64(2**64 - 1), np.bool_(True)]),
    lambda r: r.choice([np.datetime64("2020-01-01"), np.str_("load.P"), np.void(b"xyz"), np.longdouble(1)]),
    lambda r: r.choice(["", " ", "\n", "\0", "load.P\0", "load.P\n", "=", "--json", "%s%n{}", "..", "nan", "1e999"]),
    lambda r: r.choice(["\ud800", "load.\udfff", "💥" * 50, "é", "\x1b[31m", "a" * 100_000, "." * 5000, "[[" * 3000]),
    lambda r: r.choice([b"", b"load.P", b"\xff\xfe", bytearray(b"load.P"), memoryview(b"abc")]),
    lambda r: r.choice([[], [None], [[1, 2], [3]], ["load.P"], [1, "a"], (), (1, 2), [float("nan")] * 3, [[[]]]]),
    lambda r: r.choice([recursive_list, recursive_dict])(),
    lambda r: r.choice([set(), {1, "a"}, frozenset(), range(3), iter([1, 2]), (i for i in range(3)), slice(None)]),
    lambda r: np.zeros(r.choice([0, 1, 2, 3, 4, 1000])),
    lambda r: np.zeros(r.choice([(2, 2), (0, 3), (), (1, 1, 1), (3, 1)])),
    lambda r: np.arange(12.0)[:: r.choice([2, -1, 5])],
    lambda r: np.asfortranarray(np.ones((3, 4))).T[::2],
    lambda r: np.array(r.choice([[1, 2], [True], [1j], ["a", "b"], [None], [{}]])),
    lambda r: np.zeros(3, dtype=r.choice([">f8", "f4", "i8", "u1", "M8[s]", "O", [("a", "f8")], "f2"])),
    lambda r: np.array([r.choice([float("nan"), float("inf"), 1e308])] * 3),
    lambda r: r.choice([read_only, lambda: np.ma.masked_array([1.0, 2.0], [True, False])])(),
    lambda r: r.choice([{}, {1: 2}, {"load.P": None}, {"load.P": float("nan")}, {"no.such": 1}, {None: None}, {"": 1}]),
    lambda r: r.choice([{"load.P": [1, 2]}, {"load.P": "1"}, {"\ud800": 1.0}, {"load.P": 10**400}, {("a",): 1}]),
    lambda r: {"load.P": r.choice([np.zeros(3), np.zeros((2, 2)), np.array([]), np.array(["a"]), recursive_list()])},
    lambda r: raising(r.choice(["__float__", "__str__", "__len__", "__iter__", "__index__", "__fspath__"])),
    lambda r: raising("__array__"),
    lambda r: raising("__repr__"),
    lambda r: raising("__repr__", "__str__", "__float__", "__bool__", "__hash__", "__eq__", "__getattr__"),
    lambda r: {"load.P": raising("__float__", "__repr__")},
    lambda r: returning(r.choice(["__float__", "__str__", "__repr__", "__len__"]), r.choice([None, -1, "x"])),
    lambda r: returning(r.choice(["__index__", "__fspath__"]), r.choice([None, -1, "x"])),
    lambda r: returning("__array__", r.choice([None, "x", np.zeros(2)])),
    lambda r: r.choice([int, object, len, print, os, poise, lambda *a, **k: None, Own, NotImplemented, Ellipsis]),
    lambda r: r.choice([closed_file, io.StringIO, lambda: io.BytesIO(b"\xff")])(),
    lambda r: pathlib.Path(r.choice([".", "nowhere.toml", "/dev/null", "a" * 300, "no/folder/out.txt"])),
    lambda r: threading.Lock(),
    lambda r: collections.defaultdict(dict),
]

# What a parameter of this name may be: with some arguments right, calls come further.
RIGHT = {
    "file": ["clamp.toml", "datasets/lift_experiment.toml", "out.txt"],
    "name": ["load.P", "P", "angle.handle", "force.rubber", "handle", "B", "grip"],
    "number": ["load.P", "P", "point.link.B.x", "spring.rubber.stiffness"],
    "vary": ["load.P", "spring.rubber.stiffness=100..900", "load.P=0..10"],
    "numbers": [{"load.P": 25}, {"P": 3.0}, {}],
    "of": ["force.rubber", "angle.handle", ["force.rubber"]],
    "for_": ["force.rubber = -700"],
    "start": [0, 0.0, "load.P"],
    "end": [10, 60.0],
    "x": [np.array([1.6, 1.5, 0.1]), [1.0, 2.0, 3.0]],
    "level": ["quiet", "normal", "verbose"],
    "table": ["angles", "springs", "points"],
    "text": ["[ground]\npoints = { A = [0, 0] }\n"],
    "progress": [None, lambda doing: None],
    "command": ["solve", "path", "check"],
    "options": [[("SCENE", "clamp.toml")], []],
    "scene": ["clamp.toml"],
}


def is_public(name):
    return not name.startswith("_") and name not in LEFT_OUT


def may_be_called(thing):
    """Whether users call it: what only holds an object of the compiled part is made by the module alone."""
    if not (getattr(thing, "__module__", None) or "").startswith("poise"):
        return False
    if thing in (poise.Many, poise.ManyPaths):
        return False
    return not isinstance(thing, type) or "core" not in (signature_of(thing)[0] or [])


def words_of_commands():
    """The options of all commands, as keywords are spelled."""
    names = set()
    for command in poise._poise.commands():
        for option in command["options"]:
            word = option["name"].lstrip("-").replace("-", "_").lower()
            names.add(word + "_" if word in ("from", "for", "with") else word)
    return sorted(names)


def signature_of(thing):
    """Names of the parameters that can be given, and whether any other positional or keyword is taken."""
    try:
        parameters = list(inspect.signature(thing).parameters.values())
    except (TypeError, ValueError):
        return None, True, False
    named = [p.name for p in parameters if p.kind in (p.POSITIONAL_OR_KEYWORD, p.KEYWORD_ONLY)]
    kinds = {p.kind for p in parameters}
    return named, inspect.Parameter.VAR_POSITIONAL in kinds, inspect.Parameter.VAR_KEYWORD in kinds


class Caller:
    def __init__(self, seed):
        self.random = random.Random(seed)
        self.words = words_of_commands()
        scene = poise.load("clamp.toml")
        rest = scene.solve(P=25)
        many = scene.solve_many({"load.P": [0, 25]}, of="force.rubber")
        self.pool = [poise, poise._poise, poise.measures]
        for thing in (scene, rest, many, scene.path("load.P", 0, 60), scene.equilibria(), scene.system(),
                      scene.certify(rest.x), poise.SceneBuilder("built"),
                      poise.Experiment("datasets/lift_experiment.toml")):
            self.keep(thing)
        self.kept = len(self.pool)

    def keep(self, thing):
        """Hold what is Poise's, of which methods are called later."""
        for one in (thing, getattr(thing, "_core", None)):
            if not type(one).__module__.startswith("poise") or isinstance(one, (type, BaseException)):
                continue
            if len(self.pool) > 60:
                del self.pool[self.random.randrange(self.kept, len(self.pool))]
            self.pool.append(one)

    def value(self, name=None):
        chosen = self.random.random()
        if name in RIGHT and chosen < 0.5:
            return self.random.choice(RIGHT[name])
        if chosen > 0.95:
            return self.random.choice(self.pool)
        return self.random.choice(WRONG)(self.random)

    def target(self):
        """An object and the name of something public of it."""
        while True:
            thing = self.random.choice(self.pool)
            if isinstance(thing, types.ModuleType):
                names = [name for name in vars(thing) if is_public(name) and may_be_called(vars(thing)[name])]
            else:
                kinds = [kind for kind in type(thing).__mro__ if kind.__module__.startswith("poise")]
                names = sorted({name for kind in kinds for name in vars(kind) if is_public(name) or name in SPECIAL})
            if names:
                return thing, self.random.choice(names)

    def arguments(self, function):
        named, positional, keywords = signature_of(function)
        args, kwargs = [], {}
        if named is None:
            names = self.random.choices(["name", "numbers", "x", "text"], k=self.random.randrange(4))
            args = [self.value(name) for name in names]
        else:
            for name in named:
                if self.random.random() < 0.85:
                    kwargs[name] = self.value(name)
            if positional and self.random.random() < 0.5:
                args.append(self.value("numbers"))
        if keywords and self.random.random() < 0.5:
            for word in self.random.sample(self.words, 2):
                kwargs[word] = self.value(word)
        if keywords and self.random.random() < 0.2:
            kwargs[self.random.choice(["", "\ud800", "a" * 5000, "load.P", "P", "self"])] = self.value()
        if self.random.random() < 0.05:
            args.append(self.value())
        return args, kwargs

    def call(self, log):
        thing, name = self.target()
        log(f"{type(thing).__name__}.{name}")
        member = getattr(thing, name)
        log(" of ", type(member).__name__)
        result = member
        if callable(member):
            args, kwargs = self.arguments(member)
            log(shown(args), shown(kwargs))
            result = member(*args, **kwargs)
        for value in result if isinstance(result, (list, tuple)) and len(result) < 20 else [result]:
            self.keep(value)
        if type(result).__module__.startswith("poise"):
            log(" repr")
            repr(result)
            str(result)


def shown(thing):
    try:
        return " " + " ".join(ascii(thing)[:300].split())
    except BaseException:
        return f" ({type(thing).__name__} that cannot be shown)"


def complaint(error):
    """Why an exception should not have come, or nothing."""
    if isinstance(error, poise.InputError):
        text = str(error)
        try:
            size = len(text.encode())
        except UnicodeEncodeError:
            return "its message has characters that cannot be written"
        if "\n" in text or not text.strip():
            return "its message is not one line"
        return "" if size < LONGEST_MESSAGE else f"its message has {size} bytes"
    # Sequences end with an IndexError.
    return "" if isinstance(error, (TypeError, IndexError, Own, KeyboardInterrupt)) else "it is another exception"


def main():
    seed, count, file = sys.argv[1], int(sys.argv[2]), sys.argv[3]
    faulthandler.enable()
    warnings.simplefilter("ignore")
    # Python's own handler raises KeyboardInterrupt, in C++ that runs meanwhile it is a request to stop.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    signal.signal(signal.SIGALRM, lambda *_: None)
    caller = Caller(seed)
    outcomes, wrong = collections.Counter(), []
    with open(file, "w", buffering=1) as stream:

        def log(*words):
            stream.write("".join(words))

        for index in range(count):
            log(f"\n{index}: ")
            faulthandler.dump_traceback_later(MOST_SECONDS, exit=True)
            timer = threading.Timer(SECONDS, os.kill, (os.getpid(), signal.SIGINT))
            timer.daemon = True
            try:
                timer.start()
                caller.call(log)
                outcome = "result"
            except BaseException as error:  # noqa: B902
                outcome = type(error).__name__
                why = complaint(error)
                if why:
                    place = traceback.extract_tb(error.__traceback__)[-1]
                    where = f"{pathlib.Path(place.filename).name}:{place.lineno}: {outcome}: {ascii(error)[:300]}"
                    wrong.append({"call": index, "why": why, "error": where})
            try:
                timer.cancel()
                timer.join()
            except KeyboardInterrupt:
                pass
            outcomes[outcome] += 1
        faulthandler.cancel_dump_traceback_later()
    sys.stdout.write(json.dumps({"outcomes": outcomes, "wrong": wrong}))


if __name__ == "__main__":
    main()
