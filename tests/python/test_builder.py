"""Scenes built in Python are those of files."""

import pickle

import numpy as np
import poise
import pytest
from poise import measures

CLAMP = "datasets/toggle_clamp.toml"


def clamp_builder():
    """datasets/toggle_clamp.toml in Python."""
    return (
        poise.SceneBuilder("Toggle clamp", length="mm", angle="deg")
        .source("ours")
        .gravity((0, -9810))
        .ground_point("A", (0, 60))
        .ground_point("C", [-36, 4])
        .ground_point("W", np.array([86, 30]))
        .body("handle", {"C": (0, 0), "D": (24, 0), "grip": (40, 118)}, mass=0.28, center=(26, 48), inertia=420)
        .body("link", {"D": (0, 0), "B": (36, 0)}, mass=0.06, center=(18, 0), inertia=9)
        .body("arm", {"A": (0, 0), "B": (-36, 4), "spindle": (86, 0), "T": (86, -18)}, mass=0.34, center=(24, -1),
              inertia=560)
        .pin("ground.A", "arm.A", "A")
        .pin("ground.C", "handle.C", "C")
        .pin("handle.D", "link.D", "D")
        .pin("link.B", "arm.B", "B")
        .element("spring", "rubber", measures.distance("ground.W", "arm.T"), stiffness=400, free_length=14,
                 acts="compression")
        .stop("over_centre", measures.angle("handle", "link"), min=-6, max=150)
        .stop("open", measures.angle("ground", "arm"), min=-5, max=32)
        .force("P", "handle.grip", (0, 25))
        .start("handle", 94)
        .start("link", 87.5)
        .start("arm", 0)
    )


def test_functions_of_time_are_built():
    """A mass that is driven, in a frame that is shaken: of the spring, the drive and the frame."""
    scene = (
        poise.SceneBuilder("shaken")
        .number("w", 3)
        .frame("x", as_="acceleration", sine={"amplitude": 2, "frequency": 5})
        .ground_point("O", (0, 0))
        .body("block", {"c": (0, 0)}, mass=2)
        .slide("ground.O", "block.c", (1, 0), "x")
        .element("spring", "s", measures.travel("x"), stiffness=5, free_length=1,
                 time={"stiffness": {"function": "1 + 0.1*sin(w*t)"}})
        .drive("d", measures.travel("x"),
               time={"sum": [{"function": "t^2"}, {"ramp": {"to": 1, "end": 2}}]})
        .build()
    )
    moved = scene.motion(2, rate=10)
    assert moved["travel.x"][-1] == pytest.approx(4 + 1, abs=1e-9)


def couplings_builder():
    """Every other method."""
    guide, bead = measures.travel("guide"), "bead.P"
    builder = poise.SceneBuilder("couplings", length="mm", angle="deg")
    for name, at in {"O": (0, 0), "A": (100, 0), "R": (0, -30), "S": (0, 200), "T": (0, 40)}.items():
        builder.ground_point(name, at)
    for name, points in {"a": {"O": (0, 0)}, "b": {"A": (0, 0)}, "arm": {"O": (0, 0), "P": (20, 0), "L": (30, 5)},
                         "rack": {"R": (0, 0), "Q": (10, 10)}, "bead": {"P": (0, 0)}, "wheel": {"C": (0, 0)}}.items():
        builder.body(name, points)
    return (
        builder.number("third", 1 / 3)
        .number("twice", "2*third")
        .pin("ground.O", "a.O")
        .friction(coefficient=0.1, radius=5)
        .pin("ground.A", "b.A")
        .pin("ground.O", "arm.O")
        .slide("ground.R", "rack.R", (1, 0), "guide")
        .section("arm", ["O", "L"], area=10, second_moment=4, modulus=3, height=2)
        .gear("a", "b", "mesh", ratio=0.5, internal=True, pressure_angle=20)
        .gear("a", "b", carrier="arm", ratio=2, phase=5)
        .belt("a", "b", ratio=3, crossed=np.True_, phase="twice")
        .rack("guide", "a", "teeth", radius=30)
        .geneva("a", "b", "index", slots=5, phase=10, offset=3)
        .coupling(measures.sum([(2, guide), (-1, measures.angle("ground", "a"))]), "sum", value=3)
        .cam("ground", "a", guide, [(120, "harmonic", 1), (180, "dwell"), (360, "cycloidal", 0)], "lobe", lift=10,
             base=40, guided=True, roller="rack.Q")
        .cam("ground", "b", guide, curve=np.array([[0, 0], [90, 1], [180, 0.5], [360, 0]]), lift=4, base=20)
        .rope(["ground.S", ("arm.L", 5, "clockwise"), bead], "hoist", length=400)
        .chain("arm.O", "ground.T", "strand", radius_a=5, radius_b=8, turn="clockwise", slack=True)
        .circular_slot(bead, "arm.O", "arc", radius=20, from_=-30, to=60)
        .curved_slot(bead, "arm.P", [(0, 0), (10, 4), (20, 0)], "groove", closed=True)
        .rolling("wheel.C", "ground.T", (1, 2), "floor", radius=15)
        .rolling_on_circle("wheel.C", "a.O", "drum", radius=6, circle_radius=30, inside=True, offset=2)
        .rolling_profile("wheel.C", [(-10, 4), (0, 0), (10, 4)], "ground.T", (1, 2), "runner", from_=2)
        .rolling_profile_on_circle("wheel.C", [(10, 0), (0, 8), (-10, 0), (0, -8)], "a.O", circle_radius=30,
                                   closed=True)
        .curve_contact("wheel.C", [(10, 0), (0, 8), (-10, 0), (0, -8)], bead, [(6, 0), (0, 9), (-6, 0), (0, -9)],
                       "touch", radius=0.5)
        .loose_pin("arm.L", "bead.P", clearance=0.5)
        .loose_slot("rack.Q", "wheel.C", (1, 2), "play", clearance=0.1)
        .contact(bead, ["arm.O", "arm.L", "arm.P"], "cup", radius=3, closed=True)
        .contact_of_outlines(["rack.R", "rack.Q"], ["arm.O", "arm.L", "arm.P"], "pawl", against_closed=True)
        .contact_with_arc(bead, "ground.T", "ground.S", "ground.S", "dish", radius=1)
        .pin_in_slot("arm.P", "rack.Q", (0, 2), "slot")
        .weld("arm.L", "bead.P", 10, "joined")
        .bar("a.O", "wheel.C", 30, "rod")
        .drive("motor", measures.angle("ground", "b"), rate=360)
        .stop("end", guide, min=-20, max=30)
        .blade("wheel.C", "edge", angle=30, on="arm")
        .element("spring", "strut", measures.sum([(1, measures.x(bead)), (1, measures.y(bead))]),
                 gas={"preload": 300, "length": 450, "stroke": 150, "ratio": 1.35})
        .force("P", bead, (1, 2), follows="bead")
        .force_along("Q", bead, (0, 1), 0)
        .distributed_load("snow", "arm.O", "arm.P", (0, -1))
        .distributed_load_along("wind", "arm.O", "arm.P", (1, 0), 2, follows="arm")
        .torque("M", "a", 7)
        .start("arc", 20)
        .start_position("wheel", (3, 4))
        .output("height", "y.arm.L")
    )


def test_a_scene_that_is_built_is_that_of_the_file():
    file, built = poise.load(CLAMP), clamp_builder().build()
    assert built.title == file.title and built.numbers == file.numbers
    assert list(built.numbers) == list(file.numbers)
    assert np.array_equal(built.solve().x, file.solve().x)
    assert built.path("load.P", 0, 60).to_dict()["events"] == file.path("load.P", 0, 60).to_dict()["events"]


def test_every_method_writes_what_the_reader_reads():
    builder = couplings_builder()
    text = builder.toml
    for item in ("gear", "belt", "rack", "geneva", "coupling", "cam", "rope", "chain", "circular_slot", "curved_slot", "rolling",
                 "rolling_on_circle", "rolling_profile", "rolling_profile_on_circle", "curve_contact", "loose_pin",
                 "loose_slot",
                 "contact", "pin_in_slot", "weld", "bar", "drive", "stop", "blade", "spring", "force", "distributed_load",
                 "torque"):
        assert f"[[{item}]]" in text
    scene = builder.build()
    assert scene.numbers["numbers.third"] == 1 / 3 and scene.numbers["spring.strut.gas.ratio"] == 1.35
    assert scene.toml == text


def test_parts_are_brought_as_by_a_file(tmp_path, monkeypatch):
    (tmp_path / "stage.toml").write_text(open("datasets/parts/scissor_stage.toml").read())
    monkeypatch.chdir(tmp_path)
    builder = (
        poise.SceneBuilder("two stages", angle="deg")
        .number("turn", 5)
        .body("slider", {"S": (0, 0)})
        .ground_point("O", (0, 0))
        .slide("ground.O", "slider.S", (1, 0), "base")
        .part("stage.toml", "stage", at=(3, 4), angle="2*turn", repeat=2, step=("turn", 0.5), mirror=True,
              join={"left": "ground.O"}, join_next={"left": "fall.b"},
              numbers={"m": 7, "point.ground.right.x": 1.1})
    )
    scene = builder.build()
    assert scene.numbers["body.stage_2.fall.mass"] == 7 and scene.numbers["point.stage_1.ground.right.x"] == 1.1
    assert scene.numbers["point.ground.stage_2.x"] == pytest.approx(8)
    assert scene.with_numbers({"numbers.turn": 6}).numbers["weld.stage_2.angle"] == 12
    scene.save(tmp_path / "saved.toml")
    assert poise.load(tmp_path / "saved.toml").numbers == scene.numbers
    with pytest.raises(poise.InputError, match='two stages: part "late".file: expected a file that is there'):
        builder.part("stge.toml", "late").build()


def test_all_methods_of_the_core_are_methods():
    core = {name for name in dir(poise._poise.SceneBuilder) if not name.startswith("_")}
    assert core - {"text"} <= {name for name in dir(poise.SceneBuilder) if not name.startswith("_")}


def test_a_scene_that_is_built_is_pickled_and_saved(tmp_path):
    scene = clamp_builder().build().with_numbers({"spring.rubber.stiffness": 0.1 + 0.2})
    again = pickle.loads(pickle.dumps(scene))
    assert again == scene and again.numbers == scene.numbers
    scene.save(tmp_path / "clamp.toml")
    assert poise.load(tmp_path / "clamp.toml").numbers == scene.numbers


def test_controllers_may_follow_each_other():
    built = (
        poise.SceneBuilder("axis")
        .ground_point("O", (0, 0))
        .body("block", {"c": (0, 0)}, mass=2)
        .slide("ground.O", "block.c", (1, 0), "x")
        .element("controller", "place", measures.nothing(), reads={"slide": "x"}, proportional=3, reference=0.25)
        .element("controller", "lag", measures.nothing(), follows="place", reads="nothing",
                 transfer={"numerator": [1], "denominator": [1, 0.01, 1e-5]})
        .element("controller", "rate", measures.travel("x"), follows="lag", reads_rate=True, proportional=40)
        .build()
    )
    assert built.motion(6, rate=1)["travel.x"][-1] == pytest.approx(0.25, abs=1e-6)


@pytest.mark.parametrize("change, line", [
    (lambda b: b.pin("arm.Q", "link.B"),
     'pin 5.points: expected a point of "arm", found "arm.Q"; did you mean "arm.A"?'),
    (lambda b: b.torque("T", "handel", 1),
     'torque "T".on: expected the name of a body other than ground, found "handel"; did you mean "handle"?'),
    (lambda b: b.gravity((0, float("nan"))), "gravity: expected a finite number, found nan"),
    (lambda b: b.gravity((0, 1, 2)), "gravity: expected two numbers, found (0, 1, 2)"),
    (lambda b: b.gravity("down"), "gravity: expected two numbers, found 'down'"),
    (lambda b: b.body("arm"), 'body.arm: expected a name of its own; "arm" is taken'),
    (lambda b: b.body("late", {"A": 3}), "body.late.points.A: expected two numbers, found 3"),
    (lambda b: b.body("late", mass="heavy"), "body.late.mass: expected a number, found 'heavy'"),
    (lambda b: b.body("late", [1]), "body: expected what help(poise.SceneBuilder.body) names, found 'late', [1]"),
    (lambda b: b.element("sprung", "s", measures.x("arm.A")), 'element "s": expected'),
    (lambda b: b.element("spring", "s", measures.x("arm.A"), stiffness=None),
     "spring.stiffness: expected a number, a text, True or False, or pairs of numbers, found None"),
    (lambda b: b.element("spring", "s", measures.x("arm.A"), curve=[(1, 2), 3]),
     "spring.curve: expected pairs of numbers, found [(1, 2), 3]"),
    (lambda b: b.element("spring", "s", "x"), "element: expected what help(poise.SceneBuilder.element) names"),
    (lambda b: b.rope(["ground.A", ("arm.T", 5)]), "rope.over: expected points"),
    (lambda b: b.cam("arm", "link", measures.x("arm.T"), [(1,)]), "cam.law: expected (to, law) or (to, law, lift)"),
    (lambda b: b.pin(3, "arm.A"), "pin: expected what help(poise.SceneBuilder.pin) names, found 3, 'arm.A', ''"),
    (lambda b: b.pin("\ud800", "arm.A"), "pin: expected what help(poise.SceneBuilder.pin) names"),
])
def test_bad_input_names_the_item_with_the_title(change, line):
    with pytest.raises(poise.InputError) as error:
        change(clamp_builder()).build()
    assert str(error.value).startswith("Toggle clamp: " + line) and "\n" not in str(error.value)


def test_measures_and_units_are_checked():
    with pytest.raises(poise.InputError, match="distance: expected what help"):
        measures.distance("a.B", 3)
    with pytest.raises(poise.InputError, match="sum: expected what help"):
        measures.sum([("twice", measures.x("a.B"))])
    with pytest.raises(poise.InputError, match="mile"):
        poise.SceneBuilder("far", length="mile").build()


def test_scene_with_a_title_begins_a_builder():
    arm = (poise.Scene("arm", length="mm", angle="deg").gravity((0, -9810)).ground_point("O", (0, 0))
           .body("arm", {"O": (0, 0)}, mass=1, center=(100, 0)).pin("ground.O", "arm.O").start("arm", -80).build())
    assert arm.solve().angle["arm"] == pytest.approx(-90, abs=1e-9)
    with pytest.raises(poise.InputError):
        poise.Scene(3)
    with pytest.raises(poise.InputError, match="load"):
        poise.Scene("datasets/toggle_clamp.toml")
