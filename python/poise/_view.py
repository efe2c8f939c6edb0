"""The live page of a scene, in a notebook's cell or in the browser."""

from __future__ import annotations

import atexit
import html
import os
import pathlib
import sys
import urllib.parse
import webbrowser
from typing import TYPE_CHECKING, Any

from . import _poise
from ._tables import EXAMPLES, checked_text

if TYPE_CHECKING:
    from ._scene import Scene

#: Pages that are served: until they are stopped they live, whoever refers to them.
_running: set[View] = set()
_process = os.getpid()


class View:
    """The live page of `poise view`, served by this process until `stop()`, the end of a `with` or of the process.

    In a notebook it is shown in the cell; `url` opens it in a tab of a browser on this machine.
    """

    def __init__(self, core: _poise.BackgroundView, page: str, height: int, is_framed: bool) -> None:
        self._core = core
        self._page = page
        self._height = height
        self._is_framed = is_framed
        _running.add(self)

    @property
    def url(self) -> str:
        """Where the page is, with its secret: whoever knows it can change the mechanism."""
        return self._core.address

    @property
    def runs(self) -> bool:
        """Whether the page is answered."""
        return self._core.runs

    def stop(self) -> None:
        """Ends the page; what is being computed for it is interrupted."""
        self._core.stop()
        _running.discard(self)

    def __enter__(self) -> View:
        return self

    def __exit__(self, *unused: object) -> None:
        self.stop()

    def __repr__(self) -> str:
        return f"<live page at {self.url}>" if self.runs else "<live page, stopped>"

    def _repr_html_(self) -> str:
        """A frame with the live page; with the page as it stands where the browser cannot reach this process."""
        size = f'width="100%" height="{self._height}" style="border: 0"'
        if self._is_framed:
            return f'<iframe src="{html.escape(self.url)}" {size} title="Poise"></iframe>'
        return (
            f'<iframe srcdoc="{html.escape(self._page)}" sandbox="allow-scripts allow-downloads" {size} '
            'title="Poise"></iframe>'
        )


def view(
    scene: Scene, *, origin: str | None = None, port: int = 0, browser: bool | None = None, height: int = 700
) -> View:
    """Scene.view()."""
    for name, value in (("port", port), ("height", height)):
        if isinstance(value, bool) or not isinstance(value, int):
            raise _poise.InputError(f"{name}: expected a whole number, found {value!r:.200}")
    if origin is not None and not isinstance(origin, str):
        raise _poise.InputError(f"origin: expected a text as \"http://localhost:8888\", found {origin!r:.200}")
    if origin is not None:
        checked_text(origin)
    if not 0 <= port <= 65535 or not 1 <= height <= 100_000:
        raise _poise.InputError(
            f"view: expected a port from 0 to 65535 and a height from 1 to 100000, found {port} and {height}"
        )
    in_notebook = _is_notebook()
    framed_by = origin if origin is not None else _notebook_origin() if in_notebook else None
    core = _poise.BackgroundView(scene._core, _is_unchanged_file(scene), framed_by, port)
    page = scene.solve().page if framed_by is None and in_notebook else ""
    shown = View(core, page, height, framed_by is not None)
    if browser or (browser is None and not in_notebook):
        webbrowser.open(shown.url)
    return shown


def _is_unchanged_file(scene: Scene) -> bool:
    """Whether the scene is what a file of the user's has now, which the page may then save."""
    if pathlib.Path(scene._core.name).is_relative_to(EXAMPLES):
        return False
    try:
        with open(scene._core.name, encoding="utf-8") as file:
            return not scene._core.changes and file.read() == scene._core.text
    except (OSError, ValueError):
        return False


def _is_notebook() -> bool:
    """Whether outputs are shown by a notebook, to a browser."""
    shell = sys.modules.get("IPython")
    running: Any = shell.get_ipython() if shell is not None else None
    return running is not None and getattr(running, "kernel", None) is not None


def _notebook_origin() -> str | None:
    """The origin of the notebook server that started this kernel, where its browser is on this machine too."""
    if any(name in os.environ for name in ("JUPYTERHUB_SERVICE_PREFIX", "SSH_CONNECTION", "COLAB_RELEASE_TAG")):
        return None
    for module in ("jupyter_server.serverapp", "notebook.notebookapp"):
        try:
            servers = list(__import__(module, fromlist=["x"]).list_running_servers())
        except Exception:  # noqa: BLE001: whatever is wrong with that package, the page is shown without it
            continue
        for server in servers:
            if str(server.get("pid")) != os.environ.get("JPY_PARENT_PID"):
                continue
            url = urllib.parse.urlsplit(str(server.get("url")))
            if url.hostname in ("localhost", "127.0.0.1"):
                return f"{url.scheme}://{url.netloc}"
    return None


@atexit.register
def _stop_all() -> None:
    if os.getpid() != _process:
        return  # a fork has not the threads that serve the pages
    for one in list(_running):
        one.stop()
