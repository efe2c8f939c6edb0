"""Experiments from arrays are those of files."""

import csv
import pickle

import numpy as np
import poise
import pytest

LIFT = "datasets/lift.toml"
ONE_RUN = """
title = "One run of the lift"
scene = "lift.toml"
[[sensor]]
name = "angle"
angle = "obd"
noise = 1e-4
column = "obd"
[[unknown]]
path = "spring.oil.stiffness"
name = "k"
start = 3e6
[[unknown]]
path = "damper.oil film.coefficient"
[[run]]
name = "middle"
rest = { angle = "obd", at = 0.3769, by = "spring.oil.free_length" }
data = "middle.csv"
"""


@pytest.fixture(scope="module")
def measured(tmp_path_factory):
    """An experiment file with a record, and the record in arrays."""
    folder = tmp_path_factory.mktemp("lift")
    scene = poise.load(LIFT)
    scene.save(folder / "lift.toml")
    scene.motion(1, release={"obd": 0.005}, rate=500, noise=1e-4).save(folder / "middle.csv")
    (folder / "one_run.toml").write_text(ONE_RUN)
    with open(folder / "middle.csv", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    time, angle = (np.array([float(row[name]) for row in rows]) for name in ("time", "obd"))
    return folder / "one_run.toml", time, angle


def fitted(fit):
    data = fit.to_dict()
    return {name: data[name] for name in ("estimates", "covariance", "sensors") if name in data}


def test_arrays_give_the_fit_of_their_file_to_the_last_bit(measured):
    file, time, angle = measured
    by_file = poise.identify(file)
    by_arrays = poise.Experiment(file, time=time, readings={"angle": angle}).identify()
    assert by_file.code == 0 and len(fitted(by_file)["estimates"]) == 2
    assert fitted(by_arrays) == fitted(by_file)
    assert np.array_equal(by_arrays.columns["angle.residual"], by_file.columns["angle.residual"])
    plain = poise.Experiment(file)
    assert fitted(plain.identify()) == fitted(by_file) and plain.toml == ONE_RUN


def test_an_experiment_in_python_is_that_of_the_file(measured):
    file, time, angle = measured
    run = {"name": "middle", "rest": {"angle": "obd", "at": 0.3769, "by": "spring.oil.free_length"}}
    unknowns = {"spring.oil.stiffness": {"name": "k", "start": 3e6}, "damper.oil film.coefficient": {}}
    experiment = poise.Experiment(
        poise.load(file.parent / "lift.toml"), sensors={"angle": {"angle": "obd", "noise": 1e-4}}, unknowns=unknowns,
        runs=[run], time=time, readings={"angle": angle})
    assert fitted(experiment.identify())["estimates"] == fitted(poise.identify(file))["estimates"]
    again = pickle.loads(pickle.dumps(experiment))
    assert fitted(again.identify()) == fitted(experiment.identify())


def test_changed_numbers_of_a_scene_are_those_of_the_experiment():
    scene = poise.load(LIFT).with_numbers({"body.payload.mass": 100})
    built = poise.Scene(poise._poise.Scene.parse(scene.toml, "built", []))
    runs = [{"release": {"obd": 0.4}, "duration": 1, "rate": 100, "seed": 3}]
    known = [poise.Experiment(one, sensors={"angle": {"read": "angle.obd", "noise": 1e-4}}, unknowns={
        "body.payload.mass": 90}, runs=runs).identify()["body.payload.mass"] for one in (scene, built)]
    assert known[0]["truth"] == known[1]["truth"] == 100 and float(known[0]) == float(known[1])


def test_several_runs_and_sensors_with_times_of_their_own(measured, tmp_path):
    file, time, angle = measured
    scene = poise.load(LIFT)
    sensors = {"angle": {"angle": "obd", "noise": 1e-4}, "stroke": {"read": "length.oil", "noise": 1e-4, "gaps": True}}
    swing = scene.motion(1, release={"obd": 0.005}, rate=500)
    rng = np.random.default_rng(7)
    stroke = swing["length.oil"] + 1e-4 * rng.standard_normal(time.size)
    stroke[5] = np.nan
    experiment = poise.Experiment(
        scene, sensors=sensors, unknowns=["spring.oil.stiffness"],
        time=[{"angle": time, "stroke": time[::2]}, time],
        readings={"angle": [angle, angle + 1e-5], "stroke": [stroke[::2], None]},
        runs=[{"name": "both"}, {"name": "angle alone"}])
    data = experiment.identify().to_dict()
    assert [run["name"] for run in data["residuals"]] == ["both", "angle alone"]
    assert data["readings"] == 2 * time.size + np.isfinite(stroke[::2]).sum()
    experiment.save(tmp_path)
    assert poise.identify(tmp_path / "experiment.toml").to_dict()["estimates"] == data["estimates"]


def test_inputs_are_arrays_too(measured):
    _, time, _ = measured
    scene = (
        poise.SceneBuilder("flywheel").ground_point("O", (0, 0)).body("wheel", {"O": (0, 0)}, mass=1, inertia=2)
        .pin("ground.O", "wheel.O").torque("motor", "wheel", 1).build())
    torque = np.sin(3 * time)
    # phi'' = sin(3 t)/J, from rest.
    angle = (time / 3 - np.sin(3 * time) / 9) / 2
    experiment = poise.Experiment(
        scene, sensors={"angle": {"read": "angle.wheel", "noise": 1e-6}}, unknowns={"body.wheel.inertia": 3},
        runs=[{"start_known": True, "release": {"wheel": 0}, "release_rate": {"wheel": 0}}], time=time,
        readings={"angle": angle}, inputs={"load.motor": torque})
    assert float(experiment.identify()["body.wheel.inertia"]) == pytest.approx(2, rel=1e-4)


def test_every_command_takes_an_experiment(measured):
    file, time, angle = measured
    experiment = poise.Experiment(file, time=time, readings={"angle": angle})
    fit = experiment.identify()
    assert experiment.validate(fit).code == 0 and fit.validate(experiment).code == 0
    assert experiment.identifiability().code == 0
    simulated = poise.Experiment(poise.load(LIFT), sensors={"angle": {"read": "angle.obd", "noise": 1e-4}}, unknowns=[
        "spring.oil.stiffness"], runs=[{"duration": 1, "rate": 100}])
    assert simulated.montecarlo(trials=2).to_dict()["trials"] == 2
    compared = poise.identify([file, experiment])
    assert compared.verdict


def bad(file, **changes):
    time = np.linspace(0, 1, 5)
    return poise.Experiment(file, **{"time": time, "readings": {"angle": np.zeros(5)}, **changes})


@pytest.mark.parametrize("call, line", [
    (lambda f: bad(f, readings={"angel": np.zeros(5)}),
     'angel: expected readings by the name of a sensor; did you mean "angle"?'),
    (lambda f: bad(f, readings={"angle": np.zeros(4)}),
     'readings["angle"]: expected shape (5,), that of its times, found (4,)'),
    (lambda f: bad(f, readings={"angle": np.zeros((5, 1))}), 'readings["angle"]: expected an array of one dimension'),
    (lambda f: bad(f, readings={"angle": [0, 1, float("nan"), 0, 0]}),
     'readings["angle"]: expected finite numbers, found nan at index 2'),
    (lambda f: bad(f, readings={"angle": [0, 1, float("inf"), 0, 0]}),
     'readings["angle"]: expected finite numbers, found inf at index 2'),
    (lambda f: bad(f, readings={"angle": ["a"] * 5}), 'readings["angle"]: expected an array of numbers'),
    (lambda f: bad(f, readings={"angle": np.zeros(5) * 1j}), 'readings["angle"]: expected an array of numbers'),
    (lambda f: bad(f, readings=np.zeros(5)), "readings: expected a dictionary with names"),
    (lambda f: bad(f, readings={}), "readings: expected an array of at least one sensor"),
    (lambda f: bad(f, time=[0, 1, 1, 2, 3]), "time: expected ascending times, found 1.0 after 1.0 at index 2"),
    (lambda f: bad(f, time=[0, 1, float("nan"), 2, 3]),
     "time: expected ascending times, found nan after 1.0 at index 2"),
    (lambda f: bad(f, time=[0, 1]), "time: expected at least 3 times, found 2"),
    (lambda f: bad(f, time=None), "time: expected arrays"),
    (lambda f: bad(f, time="soon"), "time: expected an array of numbers, found 'soon'"),
    (lambda f: bad(f, time=[np.arange(5), np.arange(5)]),
     'readings["angle"]: expected a list of 2 arrays, one for each run'),
    (lambda f: bad(f, sensors={}), "sensors: expected a Scene in place of the experiment file"),
    (lambda f: bad(f, inputs={"load.Q": np.zeros(5)}).identify(), "one_run.toml:"),
    (lambda f: poise.Experiment(3), "Experiment: expected the name of a file or a Scene, found 3"),
    (lambda f: poise.Experiment("none.toml", time=[0, 1, 2], readings={}), "none.toml: cannot be read"),
    (lambda f: poise.Experiment("none.toml").identify(), "none.toml: cannot be read"),
    (lambda f: poise.Experiment(poise.load(LIFT), sensors={"a": {"read": "angel.obd"}}, unknowns=["body.obd.mass"],
                                time=[0, 1, 2], readings={"a": [0, 0, 0]}).identify(), "experiment.toml:"),
    (lambda f: poise.Experiment(poise.load(LIFT), sensors=["a"]),
     "sensors: expected a dictionary with names, found ['a']"),
    (lambda f: poise.Experiment(poise.load(LIFT), unknowns="k"), "unknowns: expected a dictionary or a list of paths"),
    (lambda f: poise.Experiment(poise.load(LIFT), sensors={"a": {"noise": object()}}),
     "sensor.noise: expected a number, a text"),
])
def test_bad_arrays_are_bad_input(call, line, measured):
    with pytest.raises(poise.InputError) as error:
        call(measured[0])
    assert str(error.value).startswith(line) and "\n" not in str(error.value)


RIG = """
gravity = [0, -9.81]
[ground]
points = { O = [0, 0] }
[body.block]
points = { C = [0, 0] }
mass = 2
[[slide]]
name = "guide"
points = ["ground.O", "block.C"]
axis = [0, -1]
[[spring]]
name = "coil"
points = ["ground.O", "block.C"]
stiffness = 300
free_length = 0.2
[[force]]
name = "W"
at = "block.C"
vector = [0, -10]
[start]
guide = 0.3
"""


def test_readings_at_rest_are_those_of_linear_regression(tmp_path):
    (tmp_path / "rig.toml").write_text(RIG)
    scene = poise.load(tmp_path / "rig.toml")
    weights = np.linspace(0, 22, 12)
    x = 0.2 + (2 * 9.81 + weights) / 300 + 1e-4 * np.random.default_rng(2).standard_normal(12)
    experiment = poise.Experiment(
        scene, sensors={"x": {"read": "travel.guide", "noise": 1e-4}},
        unknowns=["spring.coil.stiffness", "spring.coil.free_length"],
        statics=[{"inputs": {"load.W": weights}, "readings": {"x": x}}])
    fit = experiment.identify()
    slope, length = np.polyfit(2 * 9.81 + weights, x, 1)
    assert float(fit["spring.coil.stiffness"]) == pytest.approx(1 / slope, rel=1e-8)
    assert float(fit["spring.coil.free_length"]) == pytest.approx(length, rel=1e-8)
    with pytest.raises(poise.InputError, match="statics.readings.x: expected numbers"):
        poise.Experiment(scene, sensors={"x": {"read": "travel.guide"}}, statics=[{"readings": {"x": [None, "a"]}}])
    with pytest.raises(poise.InputError, match="readings at rest alone"):
        poise.Experiment(scene, sensors={"x": {"read": "travel.guide"}}, statics=[{}], runs=[], time=[0, 1],
                         readings={"x": [0, 1]})
