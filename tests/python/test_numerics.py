"""Solvers of others reach the equilibria of Poise on its equations, and its proofs judge any place."""

import threading

import numpy as np
import poise
import pytest
import scipy.optimize
from scenes import MASS_ON_SPRING

FREE = [
    "andrews",
    "bike_suspension",
    "car_hood",
    "cam_follower",
    "curved_slot",
    "desk_lamp",
    "double_pendulum",
    "four_bar_torsion",
    "hanging_chain_10",
    "heaton_timme",
    "lift",
    "planetary_gear",
    "redundant_parallelogram",
    "rocking_chair",
    "six_bar",
    "tip_force_chain",
    "vertical_slider_crank",
]


def load(name):
    return poise.load(f"datasets/{name}.toml")


def unit_of_work(system, x):
    """A size of F, to judge what is left of it."""
    return max(1e-300, np.abs(system.gradient(x)).max())


@pytest.mark.parametrize("name", [*FREE, "toggle_clamp", "over_centre_latch"])
def test_scipy_reaches_the_equilibrium_of_poise(name):
    scene = load(name)
    rest = scene.solve()
    assert rest.proved
    system = scene.system(rest.touching) if rest.touching else scene.system()
    x = rest.x
    # A root finder has no idea in which of several equilibria a mechanism settles, and starts beside that one.
    beside = x + 1e-3 * np.where([unit == "rad" for _, unit in scene.coordinates], 1.0, np.abs(x).max())
    found = scipy.optimize.root(system.equations, beside, jac=system.jacobian, tol=1e-13)
    assert np.abs(found.x - x).max() < 1e-7 * max(1.0, np.abs(x).max()), found.message
    work, c = np.split(system.equations(x), [len(system.independent)])
    assert np.abs(work).max(initial=0) < 1e-9 * max(1.0, unit_of_work(system, x))
    assert np.abs(c).max(initial=0) < 1e-9 * max(1.0, np.abs(x).max())


def test_newton_of_ones_own_reaches_it_from_the_start():
    scene = load("four_bar_torsion")
    x = scene.start()
    r, jacobian = np.empty_like(x), np.empty((len(x), len(x)))
    for _ in range(20):
        assert scene.equations(x, out=r) is r and scene.jacobian(x, out=jacobian) is jacobian
        x = x - np.linalg.solve(jacobian, r)
    assert np.allclose(x, scene.solve().x, atol=1e-12)


def test_energy_of_scipy_is_least_where_the_arm_rests():
    scene = load("double_pendulum")
    system = scene.system()
    found = scipy.optimize.minimize(system.energy, system.start + 0.3, jac=system.gradient, hess=scene.hessian,
                                    method="trust-exact", tol=1e-12)
    certificate = scene.certify(found.x)
    assert certificate.proved and certificate.stability == "stable"


def difference(function, x, step):
    columns = []
    for i in range(len(x)):
        h = np.zeros(len(x))
        h[i] = step[i]
        # Two central differences, extrapolated: an error of h^4.
        near = (np.asarray(function(x + h)) - function(x - h)) / (2 * step[i])
        far = (np.asarray(function(x + 2 * h)) - function(x - 2 * h)) / (4 * step[i])
        columns.append((4 * near - far) / 3)
    return np.stack(columns, axis=-1)


def agrees(exact, numeric, size):
    return np.abs(exact - numeric).max(initial=0) < 2e-8 * max(np.abs(numeric).max(initial=0), size)


@pytest.mark.parametrize("name", [*FREE, "toggle_clamp", "torque_profile", "thesis_chain", "gas_lid"])
def test_derivatives_are_those_of_differences(name):
    scene = load(name)
    system = scene.system()
    x = system.start
    n, m = len(x), len(x) - len(system.independent)
    is_angle = np.array([unit == "rad" for _, unit in scene.coordinates])
    length = max(1e-3, np.abs(x[~is_angle]).max(initial=0)) if not is_angle.all() else 1.0
    rng = np.random.default_rng(40)
    x = x + 0.01 * np.where(is_angle, 1.0, length) * rng.uniform(-1, 1, n)
    step = np.where(is_angle, 1e-4, 1e-4 * length)
    if not np.isnan(system.energy(x)):
        assert agrees(system.gradient(x), difference(system.energy, x, step), unit_of_work(system, x))
    force = unit_of_work(system, x)
    assert agrees(scene.hessian(x), difference(system.gradient, x, step), force)
    assert agrees(system.closure_jacobian(x), difference(system.closures, x, step), 1.0)
    assert agrees(system.stop_jacobian(x), difference(system.stop_values, x, step), 1.0)
    assert agrees(system.jacobian(x), difference(system.equations, x, step), force)
    y = rng.uniform(-1, 1, m) * force
    z = np.concatenate([x, y])
    step = np.concatenate([step, np.full(m, 1e-3 * force)])
    with_y = difference(lambda v: system.equations(v[:n], v[n:]), z, step)
    assert agrees(system.jacobian(x, y), with_y, force)
    assert agrees(scene.hessian(x, y), with_y[:n, :n], force)


@pytest.mark.parametrize("name", ["thesis_four_bar", "lift", "six_bar", "redundant_parallelogram"])
def test_multipliers_and_directions_are_those_of_their_formulas(name):
    scene = load(name)
    system = scene.system()
    x = system.start + 0.01
    f, j = system.gradient(x), system.closure_jacobian(x)
    n, y = system.directions(x), system.multipliers(x)
    assert np.abs(j @ n).max() < 1e-12 * np.abs(j).max()
    assert np.allclose((f + j.T @ y)[system.dependent], 0, atol=1e-10 * np.abs(f).max())
    assert np.allclose(system.equations(x)[: n.shape[1]], n.T @ f, rtol=1e-9, atol=1e-10 * np.abs(f).max())
    assert np.allclose(system.equations(x, y)[system.independent], n.T @ f, rtol=1e-9, atol=1e-10 * np.abs(f).max())
    assert len(system.names) == len(x)


def test_units_are_those_of_the_scene():
    # A mass on a spring: k (y - y0) + m g = 0 in N and mm.
    scene = poise.Scene(poise._poise.Scene.parse(MASS_ON_SPRING, "mass.toml", []))
    assert scene.coordinates == [("rail", "mm")]
    y = np.array([93.0])
    assert scene.equations(y)[0] == pytest.approx(4 * (93 - 100) + 2 * 9.81, rel=1e-14)
    assert scene.jacobian(y)[0, 0] == pytest.approx(4, rel=1e-14)
    assert scene.system().energy(y) - scene.system().energy(y + 1) == pytest.approx(
        2 * (7**2 - 6**2) - 2 * 9.81, rel=1e-10)
    found = scene.certify([100 - 2 * 9.81 / 4 + 1e-3])
    assert found and found.x[0] == pytest.approx(100 - 2 * 9.81 / 4, rel=1e-13) and found.radii[0] < 1e-9
    assert scene.system().names == [("rail", "N")]


def test_certificates_judge_any_place():
    clamp = load("toggle_clamp")
    rest = clamp.solve()
    at = clamp.certify(rest.x)
    assert at.proved is True and at.stability == "stable" and at.touching == {"over_centre": "min"} == rest.touching
    assert np.abs(at.x - [1.6337822873154150442, 1.5290625321957552696, 0.0021924364015421862839]).max() < 1e-15
    assert at.radius < 1e-12 and at.unstable_directions == 0
    # The dead centre of the comment in the scene, found by SciPy: proved, and unstable.
    found = scipy.optimize.root(clamp.equations, clamp.start(), jac=clamp.jacobian, tol=1e-14)
    dead = clamp.certify(found.x)
    assert dead.proved and dead.stability == "unstable" and abs(dead.x[0] - 1.6097084123575827864) < 1e-14
    away = clamp.certify(rest.x + 0.1)
    assert away.proved is False and away.radius is None and away.x is None and away.statement
    assert not clamp.certify([1e200, -1e308, 0])


def test_stops_are_rows_apart_and_hold_where_they_are_touched():
    clamp = load("toggle_clamp")
    system = clamp.system()
    names = [row[0] for row in system.stops]
    assert names == ["over_centre", "open"]
    name, low, high, unit = system.stops[0]
    assert (low, high, unit) == (pytest.approx(np.radians(-6)), pytest.approx(np.radians(150)), "rad")
    rest = clamp.solve()
    assert system.stop_values(rest.x)[0] == pytest.approx(low, abs=1e-14)
    held = clamp.system({"over_centre": "min"})
    assert ("over_centre", "rad") in held.names and held.directions(rest.x).shape == (3, 0)
    # What the stop presses with is the virtual work of its motion: the multiplier of its row.
    place = [row for row, _ in held.names].index("over_centre")
    free = system.directions(rest.x)[:, 0]
    press = held.multipliers(rest.x)[place]
    assert (system.gradient(rest.x) + press * system.stop_jacobian(rest.x)[0]) @ free == pytest.approx(0, abs=1e-8)
    assert press < 0


@pytest.mark.parametrize(
    "call, message",
    [
        (lambda s: s.equations([1, 2]), r"x: expected an array of shape \(3,\), found one of \(2,\)"),
        (lambda s: s.equations([[1, 2, 3]]), r"found one of \(1, 3\)"),
        (lambda s: s.jacobian([1, np.nan, 3]), "x: expected finite numbers, found nan at index 1"),
        (lambda s: s.certify([np.inf, 0, 0]), "x: expected finite numbers, found inf at index 0"),
        (lambda s: s.hessian("abc"), "x: expected an array of real numbers"),
        (lambda s: s.equations(np.array([1j, 2, 3])), "expected an array of real numbers"),
        (lambda s: s.equations([1, 2, [3]]), "x: expected an array"),
        (lambda s: s.equations(None), "x: expected an array"),
        (lambda s: s.equations([1, 2, 3], out=np.zeros(2)), r"out: .* of shape \(3,\), found .* \(2,\)"),
        (lambda s: s.equations([1, 2, 3], out=np.zeros(3, np.float32)), "out: .* found one of float32"),
        (lambda s: s.equations([1, 2, 3], out=np.zeros(6)[::2]), "out: expected a writable contiguous"),
        (lambda s: s.equations([1, 2, 3], out=[1, 2, 3]), "out: "),
        (lambda s: s.hessian([1, 2, 3], multipliers=[1]), r"multipliers: expected an array of shape \(2,\)"),
        (lambda s: s.system(["over_center"]), 'touching: .* "over_center"; did you mean "over_centre"'),
        (lambda s: s.system(["open"]), 'touching: expected "min" or "max"'),
        (lambda s: s.system({"open": "top"}), 'found "top"'),
        (lambda s: s.system({"open": 1}), 'found "1"'),
        (lambda s: s.system("open"), "touching: expected a list of names"),
        (lambda s: s.system([3]), "touching: expected the name of a stop, found 3"),
        (lambda s: s.system(7), "touching: expected a list"),
        (lambda s: s.certify([1, 2, 3], farthest=-1), "farthest: expected a number > 0"),
        (lambda s: s.certify([1, 2, 3], farthest=np.nan), "farthest: expected a number > 0"),
    ],
)
def test_bad_input_is_one_line(call, message):
    with pytest.raises(poise.InputError, match=message) as found:
        call(load("toggle_clamp"))
    assert "\n" not in str(found.value)


def test_several_threads_use_one_system():
    scene = load("lift")
    x = scene.start() + np.linspace(0, 0.1, 200)[:, None]
    alone = [scene.equations(one) for one in x]
    wrong = []

    def work():
        for _ in range(20):
            wrong.extend(k for k, one in enumerate(x) if not np.array_equal(scene.equations(one), alone[k]))

    threads = [threading.Thread(target=work) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not wrong
