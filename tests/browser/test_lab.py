"""The tour as a student meets it: `backhoe lab`, a real JupyterLab in Chromium, Run All."""

import os
import socket
import subprocess
import sys
import time
import urllib.error
import urllib.request

import nbformat
import pytest

from backhoe.course import workspace

TOKEN = "digger"
CELLS = """() => window.jupyterapp.shell.currentWidget.content.widgets
    .filter(cell => cell.model.type === "code")
    .map(cell => ({count: cell.model.executionCount, source: cell.model.sharedModel.source,
                   outputs: cell.model.outputs.toJSON()}))"""
SCROLL = """async text => {
    const notebook = window.jupyterapp.shell.currentWidget.content;
    const shown = cell => JSON.stringify(cell.model.toJSON().outputs ?? []);
    notebook.activeCellIndex = notebook.widgets.findIndex(cell => shown(cell).includes(text));
    await notebook.scrollToItem(notebook.activeCellIndex, "smart");
}"""


def _ask(address, method="GET"):
    request = urllib.request.Request(address, method=method)
    request.add_header("Authorization", f"token {TOKEN}")
    return urllib.request.urlopen(request, timeout=10)


def _free_port():
    with socket.socket() as place:
        place.bind(("127.0.0.1", 0))
        return place.getsockname()[1]


@pytest.fixture(scope="module")
def lab(chromium, tmp_path_factory):
    """The address of a JupyterLab started by `backhoe lab` on a fresh copy of the lessons."""
    place = tmp_path_factory.mktemp("lab")
    own = ("JUPYTER_RUNTIME_DIR", "JUPYTER_CONFIG_DIR", "JUPYTERLAB_SETTINGS_DIR")
    address = f"http://127.0.0.1:{_free_port()}"
    options = ["--no-browser", "--allow-root", f"--port={address.rpartition(':')[2]}"]
    options += [f"--IdentityProvider.token={TOKEN}", "--LabApp.expose_app_in_browser=True"]
    options += [f"--LabApp.workspaces_dir={place / 'workspaces'}"]
    with open(place / "log", "w", encoding="utf-8") as log:
        server = subprocess.Popen(
            [sys.executable, "-m", "backhoe", "lab", "--folder", "mine", *options],
            cwd=place,
            env={**os.environ, **{name: str(place / name) for name in own}},
            stdout=log,
            stderr=subprocess.STDOUT,
        )
    try:
        for _ in range(600):
            assert server.poll() is None, (place / "log").read_text(encoding="utf-8")
            try:
                _ask(f"{address}/api/status").close()
                break
            except (urllib.error.URLError, ConnectionError):
                time.sleep(0.1)
        yield address
        _ask(f"{address}/api/shutdown", "POST").close()
        server.wait(60)
    finally:
        server.kill()


@pytest.fixture(scope="module")
def tour(chromium, lab):
    """The tour's page after Run All, with the addresses that it asked outside this machine."""
    context = chromium.new_context(viewport={"width": 1280, "height": 900})
    outside = []

    def block(route):
        if route.request.url.startswith((lab, "data:", "blob:")):
            route.continue_()
        else:
            outside.append(route.request.url)
            route.abort()

    context.route("**/*", block)
    page = context.new_page()
    page.outside = outside
    page.set_default_timeout(120_000)
    page.goto(f"{lab}/lab/tree/00_tour.ipynb?token={TOKEN}")
    idle = page.locator("#jp-main-statusbar").get_by_text("Idle")
    idle.wait_for()
    page.locator("#jp-MainMenu").get_by_text("Run", exact=True).click()
    page.get_by_role("menuitem", name="Run All Cells", exact=True).click()
    page.wait_for_function(f"({CELLS})().every(cell => cell.count > 0)", timeout=300_000)
    idle.wait_for()
    yield page
    context.close()


def test_a_fresh_copy_shows_no_answers_and_its_pictures(tour, lab):
    with _ask(f"{lab}/files/07a_beliefs.ipynb") as file:
        assert b'"outputs": []' in file.read()
    loaded = "picture => picture.complete && picture.naturalWidth > 0"
    assert tour.locator(".jp-RenderedMarkdown img").first.evaluate(loaded)


def test_opens_without_questions_or_news(tour):
    assert tour.locator(".jp-Dialog").count() == 0
    assert tour.locator(".Toastify__toast").count() == 0


def test_run_all_runs_every_cell_once_and_none_complains(tour):
    cells = tour.evaluate(CELLS)
    assert [cell["count"] for cell in cells] == list(range(1, len(cells) + 1))
    for cell in cells:
        kinds = {output.get("name", output["output_type"]) for output in cell["outputs"]}
        assert kinds <= {"stdout", "display_data", "execute_result"}, cell


def test_run_all_prints_what_the_notebook_stores(tour):
    stored = nbformat.read(workspace.root() / "notebooks" / "00_tour.ipynb", as_version=4)
    code = [cell for cell in stored.cells if cell.cell_type == "code"]

    def printed(outputs):
        texts = [output.get("text", "") for output in outputs if output["output_type"] == "stream"]
        return "".join("".join(text) for text in texts)

    for cell, ran in zip(code, tour.evaluate(CELLS), strict=True):
        assert printed(ran["outputs"]) == printed(cell.outputs)


def test_slider_moves_a_picture(tour):
    tour.evaluate(SCROLL, "vnd.jupyter.widget-view")
    cell = tour.locator(".jp-Cell", has=tour.locator(".noUi-handle")).first
    handle = cell.locator(".noUi-handle").first
    picture = cell.locator(".jp-RenderedImage img").first
    before = picture.get_attribute("src")
    handle.focus()
    for _ in range(10):
        handle.press("ArrowRight")
    for _ in range(100):
        if picture.get_attribute("src") != before:
            break
        tour.wait_for_timeout(100)
    assert picture.get_attribute("src") != before


def test_replay_plays(tour):
    tour.evaluate(SCROLL, "backhoe-replay")
    frame = tour.locator("iframe[srcdoc]").first
    frame.scroll_into_view_if_needed()
    player = frame.content_frame
    time_bar = player.get_by_label("Time", exact=True)
    time_bar.wait_for()
    before = float(time_bar.input_value())
    player.get_by_role("button", name="Play", exact=True).first.click()
    for _ in range(200):
        if float(time_bar.input_value()) > before + 0.5:
            break
        tour.wait_for_timeout(100)
    assert float(time_bar.input_value()) > before + 0.5


def test_no_other_host_was_asked(tour):
    assert tour.outside == []
