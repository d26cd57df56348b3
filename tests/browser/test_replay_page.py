"""The replay in a real browser: it plays without network and by keyboard alone."""

import io

import numpy as np
import pytest
from matplotlib.image import imread

from backhoe.machine import BACKHOE
from backhoe.view import replay
from backhoe.view.replay.recording import HeightField, Recording, Scalar
from backhoe.view.replay.stage import machine_nodes

ALT = 'The arm digs a pit & says "<hello>".'


def digging(frames=91):
    times = np.arange(frames) / 30
    q = np.sin(times[:, None] * [0.3, 0.5, 0.7, 0.9]) - [1.5, 0, 0, 0]
    y, x = np.mgrid[-3:3:60j, 3:9:60j]
    field = HeightField("ground", np.exp(-((x - 6) ** 2) - y**2), 0.1017, (3.0, -3.0))
    for frame in range(1, frames):
        field.append(np.exp(-((x - 6) ** 2) - y**2) * (1 - frame / frames))
    volume = np.linspace(0, 0.5, frames)
    nodes = machine_nodes(q, np.zeros((frames, 3)), BACKHOE, loaded=True)
    recording = Recording(
        times,
        nodes,
        fields=(field,),
        scalars=(Scalar("bucket", volume, "bucket", "m³"),),
        labels=((0.0, "dig"), (2.0, "lift")),
        follow="bucket",
        trail="bucket",
    )
    return replay.Replay(recording, title="dig", alt=ALT)


@pytest.fixture(scope="module")
def notebook_output(tmp_path_factory):
    path = tmp_path_factory.mktemp("replay") / "output.html"
    html = digging()._repr_html_()
    path.write_text(f"<!doctype html><meta charset=utf-8><body>{html}</body>", encoding="utf-8")
    return path


class Player:
    """What a reader of the page sees and does."""

    def __init__(self, page, path):
        self.requests, self.errors = [], []
        page.on("request", lambda request: self.requests.append(request.url))
        page.on("pageerror", lambda error: self.errors.append(str(error)))
        page.on(
            "console", lambda said: self.errors.append(said.text) if said.type == "error" else 0
        )
        page.context.set_offline(True)
        page.goto(path.as_uri())
        self.page, self.inside = page, page.frame_locator("iframe")
        self.bar = self.inside.get_by_label("Time", exact=True)
        self.bar.wait_for()
        self.canvas = self.inside.locator("canvas")

    def note(self, said):
        if said.type == "error":
            self.errors.append(said.text)

    @property
    def time(self):
        return float(self.bar.input_value())

    def press(self, *keys):
        for key in keys:
            self.page.keyboard.press(key)

    def until(self, what, seconds=20):
        for _ in range(10 * seconds):
            if what():
                return True
            self.page.wait_for_timeout(100)
        return False

    def picture(self):
        drawn = (
            "() => new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))"
        )
        self.inside.locator("body").evaluate(drawn)
        return imread(io.BytesIO(self.canvas.screenshot()))[..., :3]


@pytest.fixture
def page(chromium):
    context = chromium.new_context(viewport={"width": 640, "height": 600})
    page = context.new_page()
    yield page
    context.close()


@pytest.fixture(scope="module")
def opened(chromium, notebook_output):
    context = chromium.new_context(viewport={"width": 640, "height": 600})
    player = Player(context.new_page(), notebook_output)
    player.canvas.focus()
    player.press("ArrowRight")
    yield player
    context.close()


@pytest.fixture
def player(opened):
    """One page for many tests, each from the start of the recording and the first view."""
    opened.canvas.focus()
    opened.press("Home", "r")
    assert opened.until(lambda: opened.time == 0)
    return opened


def test_it_waits_then_plays_to_the_end_offline(page, notebook_output):
    player = Player(page, notebook_output)
    player.page.wait_for_timeout(700)
    assert player.time == 0
    player.inside.get_by_label("Play").first.click()
    assert player.until(lambda: 0 < player.time < 3)
    assert player.until(lambda: player.time == 3)
    assert player.inside.locator(".bar").get_by_label("Play").is_visible()
    assert player.errors == []
    assert [url for url in player.requests if not url.startswith(("file:", "about:"))] == []
    assert len([url for url in player.requests if url.startswith("file:")]) == 1


def test_space_plays_and_pauses(player):
    player.press("Space")
    assert player.until(lambda: player.time > 0.1)
    player.press("Space")
    player.page.wait_for_timeout(300)
    stopped = player.time
    player.page.wait_for_timeout(700)
    assert 0 < stopped == player.time


def test_keys_scrub(player):
    player.canvas.focus()
    player.press("ArrowRight", "ArrowRight")
    assert player.until(lambda: player.time == 1.0)
    player.press("ArrowLeft", ".")
    assert player.until(lambda: player.time == pytest.approx(0.5 + 1 / 30, abs=2e-3))
    player.press("End")
    assert player.until(lambda: player.time == 3.0)
    player.press("Home", ",")
    assert player.until(lambda: player.time == 0.0)


def test_readouts_follow_the_time(player):
    readout = player.inside.locator(".readout")
    assert "dig" in readout.inner_text() and "0.00 m³" in readout.inner_text()
    player.canvas.focus()
    player.press("End")
    assert player.until(lambda: "lift" in readout.inner_text())
    assert "0.50 m³" in readout.inner_text()
    assert "3.0 / 3.0 s" in player.inside.locator(".time").inner_text()


def test_the_picture_shows_the_machine_and_the_ground(player):
    pixels = player.picture()
    red, green, blue = pixels.reshape(-1, 3).T
    yellow = (red > 0.5) & (green > 0.35) & (blue < 0.25)
    assert 0.01 < yellow.mean() < 0.5
    assert len(np.unique((pixels * 31).astype(int).reshape(-1, 3), axis=0)) > 100


def test_going_there_and_back_gives_the_same_picture(player):
    before = player.picture()
    player.canvas.focus()
    player.press("End")
    there = player.picture()
    player.press("Home")
    back = player.picture()
    assert np.abs(there - before).mean() > 0.01
    assert np.abs(back - before).mean() < 0.002


@pytest.mark.parametrize("key", ["Shift+ArrowLeft", "Shift+ArrowUp", "+", "w", "1", "2", "3", "t"])
def test_keys_change_the_view_and_r_restores_it(player, key):
    player.canvas.focus()
    player.press("ArrowRight", "ArrowRight")
    before = player.picture()
    player.press(key)
    assert np.abs(player.picture() - before).mean() > 2e-4
    player.press("t" if key == "t" else "r")
    assert np.abs(player.picture() - before).mean() < 1e-4


def test_dragging_turns_the_view(player):
    before = player.picture()
    box = player.canvas.bounding_box()
    player.page.mouse.move(box["x"] + 200, box["y"] + 300)
    player.page.mouse.down()
    player.page.mouse.move(box["x"] + 330, box["y"] + 320, steps=4)
    player.page.mouse.up()
    assert np.abs(player.picture() - before).mean() > 0.01


def test_every_control_has_a_name_and_the_tab_key_reaches_it(player):
    controls = player.inside.locator("button:visible, input:visible, select:visible, canvas")
    names = [controls.nth(i).get_attribute("aria-label") for i in range(controls.count())]
    assert len(names) >= 10 and all(names)
    assert f"3D view. {ALT}" in names
    player.canvas.focus()
    body = player.inside.locator("body")
    focused = {body.evaluate("() => document.activeElement.ariaLabel")}
    for _ in names[1:]:
        player.press("Tab")
        focused.add(body.evaluate("() => document.activeElement.ariaLabel"))
    assert focused == set(names)


def test_phone_width_has_no_sideways_scroll(page, notebook_output):
    page.set_viewport_size({"width": 360, "height": 640})
    player = Player(page, notebook_output)
    assert player.bar.bounding_box()["width"] > 60
    inner = player.inside.locator("body").evaluate("body => body.scrollWidth")
    assert inner <= player.page.locator("iframe").bounding_box()["width"]
    play, speed = player.inside.locator(".bar button"), player.inside.get_by_label("Speed")
    for control in (play, speed):
        box = control.bounding_box()
        assert box["x"] >= 0 and box["x"] + box["width"] <= 360


def test_dark_readers_get_a_dark_page(page, notebook_output):
    page.emulate_media(color_scheme="light")
    player = Player(page, notebook_output)
    light = player.picture().mean()
    page.emulate_media(color_scheme="dark")
    assert player.picture().mean() < 0.6 * light


def test_without_webgl_the_page_says_what_it_shows(page, notebook_output, tmp_path):
    """WebGL is taken away in the frame's own page: a script of the test may come too late there."""
    start = 'srcdoc="&lt;!doctype html&gt;'
    text = notebook_output.read_text(encoding="utf-8")
    assert text.count(start) == 1
    away = "&lt;script&gt;HTMLCanvasElement.prototype.getContext = () =&gt; null&lt;/script&gt;"
    bare = tmp_path / "bare.html"
    bare.write_text(text.replace(start, start + away), encoding="utf-8")
    page.goto(bare.as_uri())
    body = page.frame_locator("iframe").locator("body")
    body.get_by_text("needs a browser with WebGL 2").wait_for()
    assert ALT in body.inner_text()
