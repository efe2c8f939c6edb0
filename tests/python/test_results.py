"""What is found has names, units and arrays, and says the same as the files of the command line."""

import csv
import doctest
import gc
import io
import json
import os
import re
import subprocess
import sys

import numpy as np
import poise
import pytest
from poise import _found, _rest, _tables
from scenes import FALLS

CLAMP = "datasets/toggle_clamp.toml"
FOLD = 37.093431951696662419  # load.P at which the clamp opens, from its file


@pytest.fixture(scope="module")
def clamp():
    return poise.load(CLAMP)


@pytest.fixture(scope="module")
def curve(clamp):
    return clamp.path("load.P", 0, 60)


@pytest.fixture(scope="module")
def fit():
    return poise.identify("datasets/lift_experiment.toml")


def timeless(data):
    """Without what is measured by the clock: it differs from run to run."""
    if isinstance(data, dict):
        return {name: timeless(value) for name, value in data.items() if name != "microseconds"}
    return [timeless(value) for value in data] if isinstance(data, list) else data


def by_command_line(tmp_path, *words):
    files = {kind: tmp_path / f"out.{kind}" for kind in ("json", "csv")}
    options = [word for kind, file in files.items() for word in (f"--{kind}", str(file))]
    subprocess.run([os.environ["POISE_EXECUTABLE"], *words, "--quiet", *options], capture_output=True, check=False)
    return json.loads(files["json"].read_text()), files["csv"].read_text()


# ---- Rest ----


def test_rest_has_the_equilibrium_of_the_dataset(clamp):
    rest = clamp.solve(P=25)
    assert rest.found and rest and rest.proved and rest.stability == "stable" and rest.status == "confirmed"
    assert 0 < rest.radius < 1e-15
    assert rest.force["rubber"] == pytest.approx(-724.53765593476838031, rel=1e-13)
    assert rest.si.angle["handle"] == pytest.approx(1.6337822873154150442, rel=1e-14)
    assert rest["angle.handle"] == rest.angle["handle"] == pytest.approx(np.rad2deg(1.6337822873154150442), rel=1e-14)
    assert (rest.unit("angle.handle"), rest.si.unit("angle.handle")) == ("deg", "rad")
    assert rest.verdict == "In equilibrium, proved: stable."


def test_the_forces_on_the_arm_are_in_balance(clamp):
    rest = clamp.solve(P=25)
    turn = rest.si.angle["arm"]
    turned = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])

    def from_pin(place):
        return rest.point[place] - rest.point["arm.A"]

    def moment(arm, force):
        return arm[0] * force[1] - arm[1] * force[0]

    rubber = rest.point["arm.T"] - [86, 30]
    moments = [
        moment(from_pin("arm.B"), [rest["reaction.B.x"], rest["reaction.B.y"]]),
        moment(from_pin("arm.T"), -rest.force["rubber"] * rubber / np.linalg.norm(rubber)),
        moment(turned @ [24, -1], [0, -0.34 * 9.81]),
    ]
    assert abs(sum(moments)) < 1e-12 * max(map(abs, moments))
    assert rest.length["rubber"] == pytest.approx(np.linalg.norm(rubber), rel=1e-14)
    assert rest.reaction["B"] == pytest.approx(np.hypot(rest["reaction.B.x"], rest["reaction.B.y"]), rel=1e-14)


def test_families_have_the_names_of_the_scene(clamp):
    rest = clamp.solve()
    assert list(rest.angle) == ["handle", "link", "arm"] and "arm" in rest.angle and "A" not in rest.angle
    assert dict(rest.angle)["arm"] == rest["angle.arm"]
    assert set(rest.reaction) >= {"A", "B.x", "C.y"}
    for name, value in rest.items():
        assert np.isnan(value) == bool(rest.why(name)), name
    assert np.isnan(rest["push.handle.grip"]).all() and rest["push.handle.grip"].shape == (2,)
    assert np.isnan(rest.push["handle.grip.x"]) and rest.why("push.handle.grip.x") == "nothing can move"
    assert rest.why.startswith("Newton") and rest.why("energy") == ""
    assert rest["2 * energy"] == 2 * rest.energy == pytest.approx(2e3 * rest.si.energy, rel=1e-15)


@pytest.mark.parametrize("name, nearest", [("reaction.BB", "reaction.B"), ("angle.amr", "angle.arm"), ("bog", "angle")])
def test_names_that_are_none_are_answered_with_the_nearest(clamp, name, nearest):
    rest = clamp.solve()
    for asked in (lambda: rest[name], lambda: rest.si[name], lambda: rest.unit(name), lambda: rest.why(name)):
        with pytest.raises(poise.InputError, match=f"^{name}: .*did you mean.*{nearest}"):
            asked()
    for wrong in (3, None, b"energy", ["energy"]):
        with pytest.raises(poise.InputError, match="expected a name in quotes"):
            rest[wrong]


def test_what_is_not_found_is_said_and_no_exception(tmp_path):
    rest = poise.load(CLAMP).solve(proof=False)
    assert rest.found and rest.proved is None and rest.radius is None and rest.stability is None
    scene = tmp_path / "falls.toml"
    scene.write_text(FALLS)
    falling = poise.load(scene).solve()
    assert not falling.found and not falling and falling.code == 1 and falling.proved is False
    assert falling.stability is None and falling.radius is None and falling.why
    assert np.isnan(falling.energy) and falling.why("energy") == "no equilibrium was found"


# ---- Arrays ----


def test_arrays_are_views_that_outlive_what_they_come_from(clamp):
    curve = clamp.path("load.P", 0, 60)
    column, again = curve["load.P"], curve._core.columns()["parameter"][0]
    assert np.shares_memory(column, again) and not column.flags.owndata and not column.flags.writeable
    part = curve.branches[1]["load.P"]
    assert np.shares_memory(part, column)
    before = column.copy(), part.copy()
    rest = clamp.solve(P=25)
    x = rest.x
    of_rest = x.copy()
    del curve, again, rest
    gc.collect()
    others = [clamp.path("load.P", 0, 30) for _ in range(3)]  # which would take the memory
    assert np.array_equal(column, before[0]) and np.array_equal(part, before[1]) and np.array_equal(x, of_rest)
    assert len(others) == 3


@pytest.mark.parametrize("call, words", [
    (lambda clamp: clamp.path("load.P", 0, 60, show="force.rubber"),
     ("path", CLAMP, "--vary", "load.P=0..60", "--show", "force.rubber")),
    (lambda clamp: clamp.equilibria(), ("equilibria", CLAMP)),
    (lambda clamp: poise.load("datasets/double_pendulum.toml").motion(duration=0.5, release="arm1=1"),
     ("motion", "datasets/double_pendulum.toml", "--duration", "0.5", "--release", "arm1=1")),
])
def test_data_and_columns_are_those_of_the_command_line(clamp, tmp_path, call, words):
    found = call(clamp)
    data, lines = by_command_line(tmp_path, *words)
    assert timeless(found.to_dict()) == timeless(data)
    assert timeless(json.loads(found.json())) == timeless(data)
    assert found.csv == lines
    head, *rows = csv.reader(io.StringIO(lines))
    assert list(found.columns) == head and found.columns.rows == len(rows)
    for name, cells in zip(head, zip(*rows)):
        column = found.columns[name]
        if column.dtype.kind == "U":
            assert column.tolist() == list(cells)
        else:
            read = np.array([float(cell) if cell else np.nan for cell in cells])
            assert np.array_equal(column, read, equal_nan=True), name


# ---- Curves ----


def test_a_curve_goes_through_what_solve_finds(clamp, curve):
    assert curve.number == "load.P" and curve.status == "traced" and len(curve) == curve["load.P"].size
    force, load, handle = curve["force.rubber"], curve["load.P"], curve["angle.handle"]
    assert curve.unit("force.rubber") == "N" and curve.unit("angle.handle") == "deg"
    assert np.array_equal(handle, curve["handle"])
    rests = 0
    for k in range(0, curve.branches[0].points.stop, 10):
        if curve.stability[k] != "stable" or abs(load[k] - FOLD) < 1e-6:
            continue
        rest = clamp.solve(P=load[k])
        assert (force[k], handle[k]) == pytest.approx((rest.force["rubber"], rest.angle["handle"]), rel=1e-12)
        rests += 1
    assert rests > 3
    assert np.allclose(curve.si["angle.handle"], np.deg2rad(handle), rtol=1e-15) and curve.si.unit("handle") == "rad"
    assert curve["reaction.B"] == pytest.approx(np.hypot(curve["reaction.B.x"], curve["reaction.B.y"]), rel=1e-13)


def test_branches_and_events_of_a_curve(curve):
    data = curve.to_dict()
    assert [len(branch) for branch in curve.branches] == [branch["points"] for branch in data["branches"]]
    assert [branch.end for branch in curve.branches] == [branch["end"] for branch in data["branches"]]
    assert sum(len(branch) for branch in curve.branches) == len(curve) == curve.proved.size
    for number, branch in enumerate(curve.branches, 1):
        assert set(curve.branch[branch.points]) == {number}
        assert np.array_equal(branch["load.P"], curve["load.P"][branch.points])
    assert [event.kind for event in curve.events] == ["stop", "fold", "snap", "stop", "slack"]
    fold, snap = curve.folds[0], curve.events[2]
    assert fold["load.P"] == fold.parameter == pytest.approx(FOLD, rel=1e-12)
    assert fold["angle.handle"] == fold.angles.handle and fold["angle.arm"] == fold.angles["arm"]
    assert snap.landing["angle.handle"] == pytest.approx(23.413452192544657, rel=1e-12)
    with pytest.raises(AttributeError, match="did you mean"):
        fold.kinds
    with pytest.raises(poise.InputError, match="did you mean"):
        fold["kinds"]
    with pytest.raises(poise.InputError, match="did you mean.*angle.arm"):
        curve["angle.amr"]


def test_curves_of_folds_and_of_several_scenes(clamp):
    folds = clamp.path(vary=["load.P=0..60", "spring.rubber.stiffness=100..900"], curve="fold")
    assert folds.number == "load.P" and folds.events == [] and len(folds.branches) == len(folds.to_dict()["curves"])
    assert folds.unit("spring.rubber.stiffness") == "N/mm"
    beside = clamp.path("load.P", 0, 30, variant=["soft: spring.rubber.stiffness=300"])
    scenes = beside.columns["scene"]
    assert set(scenes) >= {"soft"} and len(beside.branches) >= 2
    for branch in beside.branches:
        assert len(set(scenes[branch.points])) == 1


# ---- The others ----


def test_equilibria_are_a_sequence_of_positions(clamp):
    found = clamp.equilibria()
    assert len(found) == 3 and found.claim == "complete" and len(list(found)) == 3
    assert [one.stability for one in found] == ["stable", "stable", "unstable"]
    here = found[found.settles_into]
    rest = clamp.solve()
    assert here["angle.arm"] == pytest.approx(rest.angle["arm"], rel=1e-12)
    assert here["reaction.B"] == pytest.approx(rest.reaction["B"], rel=1e-12)
    assert here.angles.arm == found["angle.arm"][found.settles_into] and found[-1].index == 2
    assert [one.index for one in found[:2]] == [0, 1]
    with pytest.raises(IndexError):
        found[3]


def test_motion_has_rates_that_are_derivatives():
    motion = poise.load("datasets/double_pendulum.toml").motion(duration=0.5, release="arm1=1")
    angle, rate = motion["angle.arm1"], motion["d(angle.arm1)/dt"]
    assert motion.confirmed and motion.time.shape == angle.shape == rate.shape
    step = motion.time[1] - motion.time[0]
    assert np.allclose((angle[2:] - angle[:-2]) / (2 * step), rate[1:-1], atol=1e-3)
    total = motion["energy.kinetic"] + motion["energy.potential"]
    assert np.diff(total).max() < 1e-9 < total[0] - total[-1]  # its joints damp
    assert motion.unit("d(angle.arm1)/dt") == "rad/s" and motion["reaction.shoulder"].shape == angle.shape
    assert np.array_equal(motion["x.arm1.elbow"], motion["arm1.elbow.x"])
    acceleration = motion["d(d(angle.arm1)/dt)/dt"]
    assert np.allclose((rate[2:] - rate[:-2]) / (2 * step), acceleration[1:-1], atol=0.05)
    assert motion.unit("d(d(angle.arm1)/dt)/dt") == "rad/s²"


def test_motion_has_forces_at_every_instant():
    robot = poise.load("datasets/three_motor_robot.toml")
    moved = robot.motion(duration=0.2, rate=50, motors=["shoulder", "elbow", "wrist"])
    assert moved.confirmed and moved["effort.shoulder"].shape == moved.time.shape == (11,)
    assert np.all(moved["effort.shoulder"] > 150)  # N m, it holds arm and load


def test_fit_has_estimates_with_their_covariance(fit):
    mass = fit["body.lump.mass"]
    assert mass.name == "mP" and abs(float(mass) - mass.truth) < 4 * mass.standard_error and mass.unit == "kg"
    assert mass.low < float(mass) < mass.high and repr(mass).endswith("kg") and "+-" in repr(mass)
    covariance = fit.covariance
    assert covariance.names == tuple(fit.estimates) == ("mP", "J_O", "k", "c") and covariance.shape == (4, 4)
    assert np.allclose(np.sqrt(np.diag(covariance)), list(fit.standard_errors.values()), rtol=1e-12)
    assert covariance["mP", "k"] == covariance[0, 2] == pytest.approx(covariance["k", "mP"], rel=1e-9)
    assert np.array_equal(covariance["k"], covariance[2]) and np.linalg.eigvalsh(covariance).min() > 0
    errors = np.array(list(fit.standard_errors.values()))
    assert np.allclose(fit.correlation, covariance / np.outer(errors, errors), atol=1e-9)
    with pytest.raises(poise.InputError, match="mp: expected the name of an estimate; known here: mP, J_O, k, c"):
        covariance["mp", "k"]
    columns = fit.columns
    assert np.allclose(columns["angle"] - columns["angle.prediction"], columns["angle.residual"], atol=1e-15)
    assert np.std(columns["angle.residual"]) == pytest.approx(1e-4, rel=0.02)  # the noise of the experiment
    with pytest.raises(poise.InputError, match="did you mean"):
        fit["body.lump.mas"]


def test_fit_validates_on_other_runs(fit, tmp_path):
    by_fit = fit.validate("datasets/lift_experiment.toml")
    fit.save(tmp_path / "fit.json")
    by_file = poise.validate("datasets/lift_experiment.toml", with_=tmp_path / "fit.json")
    assert timeless(by_fit.to_dict())["runs"] == timeless(by_file.to_dict())["runs"]
    assert by_fit.verdict == by_file.verdict


def test_tolerance_has_bands_with_samples(clamp):
    found = clamp.tolerance(tolerances="datasets/toggle_clamp_tolerances.toml", of="force.rubber", samples=1000)
    band = found["force.rubber"]
    assert band.nominal == pytest.approx(-724.53765593476838, rel=1e-12) and band.unit == "N"
    assert band.histogram.sum() == band["all"].count == 1000
    assert band.histogram_edges.shape == (band.histogram.size + 1,)
    assert band.continued.least >= band.histogram_edges[0] - 1e-9
    shares = [one["share"] for one in band.contributions]
    assert sum(shares) == pytest.approx(1, rel=1e-9)


def test_tolerance_and_paths_in_si(clamp):
    found = clamp.tolerance(tolerances="datasets/toggle_clamp_tolerances.toml", of="angle.arm", samples=200)
    plain, si = found["angle.arm"], found.si["angle.arm"]
    assert (plain.unit, si.unit) == ("deg", "rad") and si.sigma == pytest.approx(np.deg2rad(plain.sigma), rel=1e-14)
    assert np.allclose(si.histogram_edges, np.deg2rad(plain.histogram_edges))
    assert si.continued.mean == pytest.approx(np.deg2rad(plain.continued.mean), rel=1e-14)


def test_other_results_have_their_data_by_name():
    held = poise.load("datasets/friction/" + sorted(os.listdir("datasets/friction"))[0]).hold()
    assert held["proved"] == held.to_dict()["proved"] and "verdict" in held.keys()
    with pytest.raises(poise.InputError, match="did you mean"):
        held["prooved"]
    assert bool(held) == (held.code == 0)


@pytest.mark.parametrize("unit, si, factor", [
    ("mm", "m", 1e-3), ("N mm/deg", "N m/rad", 1e-3 * 180 / np.pi), ("N/mm²", "N/m²", 1e6), ("", "", 1.0),
    ("lbf/in²", "N/m²", 6894.757293168361), ("1/s", "1/s", 1.0), ("J", "J", 1.0), ("deg/s²", "rad/s²", np.pi / 180),
    ("lb ft", "kg m", 0.45359237 * 0.3048), ("kg mm²", "kg m²", 1e-6),
])
def test_units_have_si_values(unit, si, factor):
    name, value = _tables.si_unit(unit)
    assert name == si and value == pytest.approx(factor, rel=1e-14)


# ---- Frames, files, texts ----


def test_frames_of_pandas(clamp, curve, fit):
    pandas = pytest.importorskip("pandas")
    rest = clamp.solve(P=25)
    frame = rest.to_frame()
    assert frame.loc["force.rubber", "value"] == rest.force["rubber"] and frame.loc["angle.arm", "unit"] == "deg"
    assert frame.loc["push.handle.grip.x", "why"] == "nothing can move"
    table = curve.to_frame()
    assert table.equals(pandas.read_csv(io.StringIO(curve.csv), float_precision="round_trip").astype(table.dtypes))
    assert table.attrs["units"]["parameter"] == "N"
    assert list(fit.to_frame().index) == list(fit.estimates)
    assert list(rest.to_frame("reactions")["name"]) == [one["name"] for one in rest.to_dict()["reactions"]]
    with pytest.raises(poise.InputError, match="did you mean"):
        rest.to_frame("reaction")


def test_without_pandas_and_matplotlib_it_is_said_how_to_get_them(clamp, monkeypatch):
    rest = clamp.solve()
    monkeypatch.setitem(sys.modules, "pandas", None)
    monkeypatch.setitem(sys.modules, "matplotlib.pyplot", None)
    with pytest.raises(ImportError, match="to_frame\\(\\) needs pandas; install python3-pandas"):
        rest.to_frame()
    with pytest.raises(ImportError, match="plot\\(\\) needs matplotlib; install python3-matplotlib"):
        rest.plot()


def test_without_gnuplot_charts_are_on_the_page_alone(clamp, tmp_path, monkeypatch):
    monkeypatch.setenv("PATH", str(tmp_path))
    curve = clamp.path("load.P", 0, 10)
    curve.save(tmp_path / "curve.html")
    clamp.solve().save(tmp_path / "clamp.svg")
    with pytest.raises(poise.InputError, match="this has no svg to write; a chart needs gnuplot, which was not found"):
        curve.save(tmp_path / "curve.svg")


def test_files_by_their_endings(curve, tmp_path):
    for ending, begin in ((".json", "{"), (".svg", "<?xml"), (".html", "<!"), (".csv", "branch,"), (".md", "#")):
        curve.save(tmp_path / f"curve{ending}")
        assert (tmp_path / f"curve{ending}").read_text(encoding="utf-8").lower().startswith(begin), ending
    with pytest.raises(poise.InputError, match="expected an ending"):
        curve.save(tmp_path / "curve.pdf")
    with pytest.raises(poise.InputError, match="has no toml"):
        curve.save(tmp_path / "curve.toml")
    with pytest.raises(poise.InputError, match="No such file"):
        curve.save(tmp_path / "nowhere" / "curve.json")
    with pytest.raises(poise.InputError, match="expected quiet, normal or verbose"):
        curve.text("loud")
    assert curve.text("quiet").strip() == curve.verdict and len(curve.text()) <= len(curve.text("verbose"))
    assert repr(curve) == curve.text().rstrip("\n") and re.search("Branches", str(curve))


@pytest.mark.parametrize("module", [_found, _rest, _tables])
def test_examples_of_docstrings(module):
    assert doctest.testmod(module).failed == 0


def test_positions_of_a_view_in_si_are_in_si():
    found = poise.load("datasets/toggle_clamp.toml").equilibria()
    assert found.si[0].energy == pytest.approx(found[0].energy * 1e-3, rel=1e-14)
    assert found.si[0]["angle.arm"] == pytest.approx(np.radians(found[0]["angle.arm"]), rel=1e-14)
    with pytest.raises(poise.InputError, match="without .si"):
        found.si.tables


def test_parts_by_name_are_asked_for_as_of_a_dictionary(clamp, curve):
    rest, equilibria = clamp.solve(), clamp.equilibria()
    many = clamp.solve_many({"load.P": [20, 30]}, of="force.rubber")
    known = [(rest.angle, "arm"), (rest.point, "arm.T"), (rest.tables["reactions"], "kind"), (curve.columns, "energy"),
             (curve.events[0], "kind"), (equilibria[0], "angle.arm"), (many, "load.P")]
    for parts, name in known:
        assert name in parts and np.array_equal(parts.get(name), parts[name])
        for other in ("nothing.of.this", "", 3, None):
            assert other not in parts and parts.get(other) is None and parts.get(other, 7) == 7
            with pytest.raises(poise.InputError):
                parts[other]
