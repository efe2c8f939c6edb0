"""Every command of the command line from Python: the same data, the same messages."""

import importlib.util
import inspect
import json
import keyword
import math
import os
import pathlib
import shlex
import subprocess

import numpy as np
import poise
import pytest
from poise import _poise
from poise._run import LEFT_OUT_OPTIONS, call_of

COMMANDS = {entry["name"]: entry for entry in _poise.commands()}
CLAMP = "datasets/toggle_clamp.toml"

#: What is short enough for a test, in place of the example or of parts of it.
SHORTER = {
    "montecarlo": {"--trials": "4"},
    "stress": {"--starts": "1", "CASE": ["dead-centre-toggle-1e-1"]},
    "tolerance": {"--samples": "2000"},
}
#: What two runs of the same program do not share, the times that it took: of every command, and of some.
LEFT_OUT = {"microseconds"}
LEFT_OUT_OF = {"montecarlo": {"seconds"}, "plan": {"seconds"}}


def example(command, folder):
    """The options of the example of --help, without files that the result is written to."""
    kinds = {option["name"]: option["kind"] for option in COMMANDS[command]["options"]}
    file = next((name for name in kinds if not name.startswith("-")), None)
    out, words = {}, iter(shlex.split(COMMANDS[command]["example"]))
    for word in words:
        name, value = (word, True if kinds[word] == "flag" else next(words)) if word.startswith("-") else (file, word)
        if name in LEFT_OUT_OPTIONS:
            continue
        if value in ("found.toml", "planned.toml", "four_bar.toml", "six_bar.dxf", "pendulum.c",
                     "pendulum.py"):
            value = str(folder / value)
        out[name] = value if kinds[name] != "list" else [*out.get(name, []), value]
    return {**out, **SHORTER.get(command, {})}


def by_command_line(command, options, folder):
    words = []
    for name, value in options.items():
        for one in value if isinstance(value, list) else [value]:
            words += ([name] if name.startswith("-") else []) + ([] if one is True else [one])
    file = folder / "by_command_line.json"
    done = subprocess.run([os.environ["POISE_EXECUTABLE"], command, *words, "--quiet", "--json", str(file)],
                          capture_output=True, text=True, check=False)
    return done.returncode, json.loads(file.read_text()) if file.exists() else done.stderr


def from_python(command, options):
    kinds = {option["name"]: option["kind"] for option in COMMANDS[command]["options"]}
    given = {}
    for name, value in options.items():
        word = name.lstrip("-").replace("-", "_").lower()
        taken = any(other.lower() == word for other in options if other != name)
        if kinds[name] in ("number", "whole number"):
            value = float(value) if kinds[name] == "number" else int(value)
        given[word + "_" if keyword.iskeyword(word) or taken else word] = value
    if "scene" in given and "SCENE" in options:
        scene = poise.load(given.pop("scene"))
        if command == "solve":
            settings = (setting.split("=") for setting in given.pop("set"))
            return scene.solve({path: float(value) for path, value in settings}, **given)
        return getattr(scene, call_of(command))(**given)
    return getattr(poise, call_of(command))(**given)


def without_times(data, command=None):
    left_out = LEFT_OUT | LEFT_OUT_OF.get(command, set())
    if isinstance(data, dict):
        return {key: without_times(value) for key, value in data.items() if key not in left_out}
    return [without_times(one) for one in data] if isinstance(data, list) else data


@pytest.fixture(scope="module")
def fit_file(tmp_path_factory):
    file = tmp_path_factory.mktemp("fit") / "fit.json"
    poise.identify("datasets/lift_experiment.toml").save(file)
    return str(file)


@pytest.mark.parametrize("command", [name for name in COMMANDS if name != "view"])
def test_the_same_data_as_by_the_command_line(command, tmp_path, fit_file):
    options = example(command, tmp_path)
    if command == "validate":
        options["--with"] = fit_file
    code, data = by_command_line(command, options, tmp_path)
    found = from_python(command, options)
    assert found.code == code
    assert without_times(found.to_dict(), command) == without_times(data, command)


def test_the_calls_are_those_that_the_table_gives():
    spec = importlib.util.spec_from_file_location("generate_commands", "python/generate_commands.py")
    generator = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(generator)
    assert pathlib.Path("python/poise/_commands.py").read_text(encoding="utf-8") == generator.text()


@pytest.mark.parametrize("command", [name for name in COMMANDS if name not in ("solve", "view")])
def test_each_option_is_a_keyword_with_its_help(command):
    call = getattr(poise.Scene, call_of(command), None) or getattr(poise, call_of(command))
    parameters = inspect.signature(call).parameters
    for option in COMMANDS[command]["options"]:
        if option["name"] in (*LEFT_OUT_OPTIONS, "SCENE"):
            continue
        name = option["name"].lstrip("-").replace("-", "_").lower()
        parameter = parameters[name + "_" if name + "_" in parameters and option["name"].startswith("-") else name]
        assert parameter.default in (None, False, inspect.Parameter.empty)
        assert f"{parameter.name}: {option['help']}".split("\n")[0] in call.__doc__
    assert list(parameters)[-1] == "progress"


def test_short_forms_are_the_long_ones():
    clamp = poise.load(CLAMP)
    long = clamp.path(vary="load.P=0..60", set="spring.rubber.stiffness=300", at="10,20").to_dict()
    softer = {"spring.rubber.stiffness": 300}
    short = clamp.path("load.P", 0, np.float64(60), set=softer, at=np.array([10, 20])).to_dict()
    assert without_times(long) == without_times(short)
    assert without_times(clamp.path(vary={"load.P": (0, 60)}, at=[10, 20]).to_dict()) == without_times(
        clamp.path("load.P", 0, 60, at="10,20").to_dict())
    found = clamp.find("spring.rubber.stiffness", 200, 800, "force.rubber = -700").to_dict()
    assert without_times(found) == without_times(
        clamp.find(vary={"spring.rubber.stiffness": (200, 800)}, for_={"force.rubber": -700}).to_dict())
    widths = {"point.*": 0.1, "spring.rubber.stiffness": {"percent": 5, "distribution": "normal"}}
    by_file = clamp.tolerance("datasets/toggle_clamp_tolerances.toml", "force.rubber", samples=500)
    by_dictionary = clamp.tolerance(widths, of=["force.rubber"], samples=500)
    assert by_dictionary.to_dict()["quantities"] == by_file.to_dict()["quantities"]


def test_changed_numbers_are_those_of_the_scene_in_every_command():
    clamp = poise.load(CLAMP)
    changed = clamp.with_numbers({"load.P": 30}, stiffness=350.1)
    assert changed.numbers["spring.rubber.stiffness"] == 350.1 and clamp.numbers["load.P"] == 25
    settings = {"load.P": 30, "spring.rubber.stiffness": 350.1}
    assert without_times(changed.modes().to_dict()) == without_times(clamp.modes(set=settings).to_dict())
    assert changed.solve()["force.rubber"] == clamp.solve(settings)["force.rubber"]


def test_response_has_its_peak_and_its_jumps():
    duffing = poise.load("datasets/duffing.toml")
    peak = duffing.response(excite="load.F", of="x.mass.C").to_dict()["resonances"][0]
    assert abs(peak["frequency"] - math.sqrt(1 - 2 * 0.02 ** 2) / (2 * math.pi)) < 1e-9
    jumps = duffing.response(excite="load.F", of="x.mass.C", from_=0.05, to=0.4, amplitude=0.2).to_dict()["periodic"]
    assert [event["jumps"] for event in jumps["events"]] == [True, True, False]
    assert abs(jumps["events"][0]["frequency"] - 1.4025723214 / (2 * math.pi)) < 1e-10


def test_what_was_found_is_the_file_of_another_command():
    lift = poise.load("datasets/lift.toml")
    motion = lift.motion(0.2, release={"obd": 0.005}, rate=200)
    forces = lift.forces(motion=motion)
    assert len(forces.columns["time"]) == len(motion) and forces.svg.startswith("<")
    fit = poise.identify("datasets/lift_experiment.toml")
    prediction = poise.validate("datasets/lift_experiment.toml", with_=fit)
    assert prediction.code == 0 and prediction.svg.startswith("<")


def test_equations_are_those_of_the_module_that_is_written(tmp_path):
    file = tmp_path / "pendulum.py"
    found = poise.load("datasets/double_pendulum.toml").equations_of_motion(
        from_="start", at={"arm1": -1, "arm2": 0.4}, rate={"arm1": 1.3, "arm2": -2.1}, python=file)
    spec = importlib.util.spec_from_file_location("pendulum", file)
    pendulum = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(pendulum)
    status, _, D, h, c, Q = pendulum.terms(found["time"], found["z"], found["w"])
    assert status == pendulum.OK
    np.testing.assert_allclose(D, [row["D"] for row in found["equation"]], rtol=1e-14)
    for name, values in [("h", h), ("c", c), ("Q", Q)]:
        np.testing.assert_allclose(values, found[name], rtol=1e-13)
    status, _, alpha = pendulum.accelerations(found["time"], found["z"], found["w"])
    np.testing.assert_allclose(alpha, found["alpha"], rtol=1e-13)
    np.testing.assert_allclose(D @ alpha + h + c, Q, rtol=0, atol=1e-14)


@pytest.mark.parametrize("words, call", [
    (["path", CLAMP, "--vary", "load.Q=0..1"], lambda clamp: clamp.path("load.Q", 0, 1)),
    (["path", CLAMP, "--vary", "load.P=0..nan"], lambda clamp: clamp.path("load.P", 0, float("nan"))),
    (["path", CLAMP, "--vary", "load.P=0..1", "--from", "here"],
     lambda clamp: clamp.path("load.P", 0, 1, from_="here")),
    (["modes", CLAMP, "--set", "load.P=inf"], lambda clamp: clamp.modes(set={"load.P": float("inf")})),
    (["equilibria", CLAMP, "--starts", "2.5"], lambda clamp: clamp.equilibria(starts=2.5)),
    (["identify", "nowhere.toml"], lambda clamp: poise.identify("nowhere.toml")),
    (["montecarlo", "datasets/lift_experiment.toml", "--trials", "0"],
     lambda clamp: poise.montecarlo("datasets/lift_experiment.toml", trials=0)),
    (["stress", "nowhere"], lambda clamp: poise.stress("nowhere")),
])
def test_bad_input_has_the_line_of_the_command_line(words, call):
    done = subprocess.run([os.environ["POISE_EXECUTABLE"], *words], capture_output=True, text=True, check=False)
    with pytest.raises(poise.InputError) as error:
        call(poise.load(CLAMP))
    assert done.returncode == 2 and str(error.value) == done.stderr.rstrip("\n")


@pytest.mark.parametrize("call, line", [
    (lambda clamp: clamp.path("load.P", 0, "60"), "--vary: load.P: expected a number, found '60'"),
    (lambda clamp: clamp.path("load.P", high=60), "--vary: expected a name with the low and the high end of its range"),
    (lambda clamp: clamp.path(3, 0, 1), "--vary: expected a text, found 3"),
    (lambda clamp: clamp.path(vary={"load.P": (0, 1, 2)}),
     "--vary: 'load.P': expected a range (low, high), found (0, 1, 2)"),
    (lambda clamp: clamp.path("load.P", 0, 1, branches=1), "--branches: expected True or False, found 1"),
    (lambda clamp: clamp.path("load.P", 0, 1, progress=1), "progress: expected a function that takes a text, found 1"),
    (lambda clamp: clamp.path("load.P", 0, 1, variant={"a": 3}), "--variant: expected a dictionary of numbers for 'a'"),
    (lambda clamp: clamp.modes(set={"load.P": [1]}), "--set: load.P: expected a number, found [1]"),
    (lambda clamp: clamp.modes(set={"load.P": True}), "--set: load.P: expected a number, found True"),
    (lambda clamp: clamp.tolerance({"point.*": object()}, "energy"), "tolerances.point.*: expected a number, a text"),
    (lambda clamp: clamp.tolerance({"poin.*": 1}, "energy"), "tolerances.toml:2: tolerances.poin.*: expected the path"),
    (lambda clamp: poise.identify(3), "EXPERIMENT: expected the name of a file, found 3"),
    (lambda clamp: poise.load("a\0b"), "a"),
])
def test_what_is_no_option_is_bad_input(call, line):
    with pytest.raises(poise.InputError) as error:
        call(poise.load(CLAMP))
    assert str(error.value).startswith(line) and "\n" not in str(error.value)


def test_progress_is_told_and_stops_the_work_where_it_raises():
    told = []
    poise.montecarlo("datasets/lift_experiment.toml", trials=3, progress=told.append)
    assert told and all(isinstance(text, str) for text in told)

    def enough(text):
        raise RuntimeError("enough")

    with pytest.raises(RuntimeError, match="enough"):
        poise.montecarlo("datasets/lift_experiment.toml", trials=10000, progress=enough)


def test_a_scene_is_saved_with_its_numbers(tmp_path):
    changed = poise.load(CLAMP).with_numbers(P=0.1 + 0.2)
    changed.save(tmp_path / "changed.toml")
    again = poise.load(tmp_path / "changed.toml")
    assert again.numbers == changed.numbers and "# A lever clamp" in again.toml
    with pytest.raises(poise.InputError, match="expected a file that can be written"):
        changed.save(tmp_path / "no_folder" / "changed.toml")
