"""The live page, served by the process that asks for it."""

import gc
import json
import shutil
import subprocess
import sys
import urllib.error
import urllib.request

import poise
import pytest

CLAMP = "datasets/toggle_clamp.toml"


def answer_of(url, **headers):
    try:
        with urllib.request.urlopen(urllib.request.Request(url, headers=headers), timeout=20) as reply:
            return reply.status, reply.headers, reply.read().decode()
    except urllib.error.HTTPError as error:
        return error.code, error.headers, ""


def test_the_page_is_served_until_it_is_stopped():
    with poise.load(CLAMP).view(browser=False) as view:
        status, headers, page = answer_of(view.url)
        assert status == 200 and "Toggle clamp" in page
        assert headers["X-Frame-Options"] == "DENY"
        assert view.runs and view.url in repr(view)
    assert not view.runs
    with pytest.raises(OSError):
        urllib.request.urlopen(view.url, timeout=5)


def test_only_the_origin_of_the_notebook_may_frame_it():
    view = poise.load(CLAMP).view(browser=False, origin="http://localhost:8888")
    frame = {"Sec-Fetch-Site": "cross-site", "Sec-Fetch-Mode": "navigate", "Sec-Fetch-Dest": "iframe"}
    status, headers, _ = answer_of(view.url, Referer="http://localhost:8888/", **frame)
    assert status == 200
    assert "frame-ancestors http://localhost:8888" in headers["Content-Security-Policy"]
    assert answer_of(view.url, Referer="http://elsewhere:8888/", **frame)[0] == 403
    assert answer_of(view.url.rsplit("/", 2)[0] + "/" + "0" * 32 + "/")[0] in (403, 404)
    assert f'src="{view.url}"' in view._repr_html_()
    view.stop()


def test_the_page_of_an_example_does_not_save_into_the_package(tmp_path):
    own = tmp_path / "clamp.toml"
    shutil.copyfile(poise.example_path("toggle_clamp"), own)
    for scene, has_file in ((poise.load(own), True), (poise.example("toggle_clamp"), False)):
        with scene.view(browser=False) as view:
            request = urllib.request.Request(view.url + "do", b'{"do": "look"}', {"Content-Type": "application/json"})
            with urllib.request.urlopen(request, timeout=20) as reply:
                assert json.load(reply)["has_file"] == has_file


def test_two_pages_of_changed_scenes_do_not_meet():
    clamp = poise.load(CLAMP)
    views = [clamp.with_numbers(P=p).view(browser=False) for p in (20.0, 30.0)]
    assert views[0].url != views[1].url
    for view in views:
        assert answer_of(view.url)[0] == 200
        view.stop()


def test_where_the_browser_cannot_reach_the_process_the_cell_has_the_page_itself():
    clamp = poise.load(CLAMP)
    core = poise._poise.BackgroundView(clamp._core, True, None, 0)
    shown = poise._view.View(core, clamp.solve().page, 700, False)._repr_html_()
    core.stop()
    assert "srcdoc=" in shown and "allow-scripts" in shown and "same-origin" not in shown


@pytest.mark.parametrize(
    "options", [{"origin": "*"}, {"origin": "http://a b"}, {"origin": 3}, {"port": 70000}, {"port": "x"}]
)
def test_bad_input_is_one_line(options):
    with pytest.raises(poise.InputError) as error:
        poise.load(CLAMP).view(browser=False, **options)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize("last", ["", "view.stop()"])
def test_python_ends_where_a_page_is_left_in_a_global_variable(last):
    program = f"""
import poise
view = poise.load("{CLAMP}").view(browser=False)
{last}
"""
    run = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=60)
    assert run.returncode == 0, run.stderr


def test_the_page_lives_without_anybody_who_refers_to_it():
    url = poise.load(CLAMP).view(browser=False).url
    gc.collect()
    assert answer_of(url)[0] == 200
    for view in list(poise._view._running):
        view.stop()
