"""Results show themselves in notebooks and in matplotlib."""

import re
import xml.etree.ElementTree as xml

import numpy as np
import poise
import pytest
from scenes import FALLS

TOLERANCES = "datasets/toggle_clamp_tolerances.toml"
FOLD = 37.093431951696662419  # load.P at which the clamp opens, from its file


@pytest.fixture(scope="module")
def clamp():
    return poise.load("datasets/toggle_clamp.toml")


@pytest.fixture(scope="module")
def results(clamp):
    return {
        "rest": clamp.solve(P=25),
        "curve": clamp.path("load.P", 0, 60),
        "equilibria": clamp.equilibria(),
        "tolerance": clamp.tolerance(tolerances=TOLERANCES, of="force.rubber", samples=500),
        "motion": poise.load("datasets/double_pendulum.toml").motion(duration=0.5, release="arm1=1"),
        "fit": poise.identify("datasets/lift_experiment.toml"),
    }


@pytest.fixture
def pyplot():
    pytest.importorskip("matplotlib").use("Agg")
    import matplotlib.pyplot

    yield matplotlib.pyplot
    matplotlib.pyplot.close("all")


KINDS = ("rest", "curve", "equilibria", "tolerance", "motion", "fit")


@pytest.mark.parametrize("kind", KINDS)
def test_notebooks_get_a_picture_and_its_table(results, kind):
    found = results[kind]
    bundle = found._repr_mimebundle_()
    assert set(bundle) == {"image/svg+xml", "text/html", "text/plain"}
    picture = xml.fromstring(bundle["image/svg+xml"])
    assert picture.tag.endswith("svg") and float(picture.get("width")) > 100
    drawn = [one for one in picture.iter() if one.tag.rpartition("}")[2] in ("line", "polyline", "path", "polygon")]
    assert len(drawn) > 10
    assert bundle["text/plain"] == repr(found) and found.verdict in bundle["text/plain"]
    html = xml.fromstring(bundle["text/html"].replace("background: white\">", "background: white\"/>"))
    assert html.find("img").get("src").startswith("data:image/svg+xml;base64,")
    assert html.findall("table") and found.verdict in [one.text for one in html.findall("p")]
    assert set(found._repr_mimebundle_(include=["text/plain"])) == {"text/plain"}
    assert set(found._repr_mimebundle_(exclude=["text/html"])) == {"image/svg+xml", "text/plain"}


def test_the_table_of_a_rest_has_its_values(results):
    html = results["rest"]._repr_html_()
    assert ">-724.538<" in html and ">93.6088297<" in html
    assert "|F| (N)" in html  # a bar that Markdown escapes


def test_pages_load_nothing(results):
    for found in results.values():
        page = found.page
        assert page.lower().startswith("<!doctype html>") and not re.search(r'(src|href)="https?:', page)


def test_pictures_are_made_once_and_when_they_are_asked_for(clamp):
    curve = clamp.path("load.P", 0, 60)
    assert curve._pictured is None
    svg = curve.svg
    made = curve._pictured
    assert svg and curve.svg == svg and curve._pictured is made
    rest = clamp.solve(P=25)
    assert rest._pictured is None and rest.svg and rest._pictured is not None


def test_what_rests_nowhere_shows_its_text(tmp_path):
    scene = tmp_path / "falls.toml"
    scene.write_text(FALLS)
    bundle = poise.load(scene).solve()._repr_mimebundle_()
    assert "A block that nothing holds" in bundle["text/plain"] and bundle["text/html"]


def test_curves_are_drawn_with_their_stability_and_folds(results, pyplot):
    curve = results["curve"]
    ax = curve.plot("force.rubber")
    assert ax.get_xlabel() == "load.P (N)" and ax.get_ylabel() == "force.rubber (N)"
    styles = {line.get_linestyle() for line in ax.lines}
    assert {"-", "--"} <= styles
    unstable = np.concatenate([line.get_xdata() for line in ax.lines if line.get_linestyle() == "--"])
    assert np.isclose(unstable.max(), FOLD)
    folds = [line for line in ax.lines if line.get_marker() == "o"]
    assert len(folds) == 1 and folds[0].get_xdata()[0] == pytest.approx(FOLD, rel=1e-12)
    assert folds[0].get_ydata()[0] == pytest.approx(-724.53765593476838, rel=1e-9)
    drawn = np.concatenate([line.get_xdata() for line in ax.lines if line.get_marker() != "o"])
    assert set(drawn) == set(curve["load.P"])
    si = curve.si.plot("angle.handle").lines[0].get_ydata()
    assert np.allclose(si, np.deg2rad(curve.plot("angle.handle").lines[0].get_ydata()), rtol=1e-14)
    own = pyplot.subplots()[1]
    assert curve.plot(ax=own) is own and own.get_ylabel() == "angle.handle (deg)"


def test_positions_are_drawn_where_they_are(results, pyplot):
    rest = results["rest"]
    ax = rest.plot()
    assert ax.get_xlabel() == "x (mm)" and ax.get_aspect() == 1.0
    drawn = np.concatenate([np.column_stack(line.get_data()) for line in ax.lines])
    for point in rest.point:
        assert np.min(np.hypot(*(drawn - rest.point[point]).T)) < 1e-9, point
    assert len(results["equilibria"].plot().get_legend().get_texts()) == 3


def test_motions_fits_and_tolerances_are_drawn(results, pyplot):
    motion, fit, tolerance = results["motion"], results["fit"], results["tolerance"]
    lines = motion.plot().lines
    assert len(lines) == 2 and np.array_equal(lines[0].get_ydata(), motion["angle.arm1"])
    assert motion.plot("reaction.shoulder").get_ylabel() == "reaction.shoulder (N)"
    ax = fit.plot(run="high, empty")
    assert len(ax.lines) == 2 and ax.get_ylabel() == "angle (rad)"
    of = fit.columns["run"] == "high, empty"
    assert np.array_equal(ax.lines[1].get_ydata(), fit.columns["angle.prediction"][of])
    assert len(fit.plot(residuals=True).lines) == 6
    ax = tolerance.plot()
    assert ax.get_xlabel() == "force.rubber (N)" and ax.lines[0].get_xdata()[0] == pytest.approx(-724.53765593476838)


def test_what_cannot_be_drawn_is_said(results, clamp):
    pytest.importorskip("matplotlib").use("Agg")
    with pytest.raises(poise.InputError, match="run.*known here|did you mean"):
        results["fit"].plot(run="nowhere")
    with pytest.raises(poise.InputError, match="did you mean"):
        results["tolerance"].plot("force.ruber")
    with pytest.raises(poise.InputError, match="no chart"):
        clamp.check().plot()
