"""The exported lessons in Chromium with no network, opened from disk as a student opens them."""

import re

import pytest

from backhoe.course import site, workspace

NAMES = ["index", *sorted(p.stem for p in workspace.root().glob("notebooks/*.ipynb"))]
PHONE = {"width": 360, "height": 740}


@pytest.fixture(scope="module")
def pages(chromium, tmp_path_factory):
    return site.build(tmp_path_factory.mktemp("site") / "lessons")


@pytest.fixture
def visit(chromium, pages):
    """Opens a page of the site; at the end nothing must have asked another host or failed."""
    contexts, outside, errors = [], [], []

    def block(route):
        if route.request.url.startswith(("file:", "data:", "blob:")):
            route.continue_()
        else:
            outside.append(route.request.url)
            route.abort()

    def open_page(name, **settings):
        context = chromium.new_context(**settings)
        contexts.append(context)
        context.route("**/*", block)
        page = context.new_page()
        page.set_default_timeout(60_000)
        page.on("pageerror", lambda error: errors.append(str(error)))
        page.goto((pages / name).as_uri(), wait_until="load")
        return page

    yield open_page
    for context in contexts:
        context.close()
    assert outside == []
    assert errors == []


@pytest.mark.parametrize("name", NAMES)
def test_page_renders_its_formulas_without_a_network(visit, name):
    page = visit(f"{name}.html")
    formulas = page.locator(".math").count()
    if formulas:
        page.wait_for_function(
            "n => document.querySelectorAll('.math mjx-container').length >= n", arg=formulas
        )
    assert page.locator("mjx-merror, [data-mjx-error]").count() == 0


@pytest.mark.parametrize("name", NAMES)
def test_page_fits_a_phone(visit, name):
    page = visit(f"{name}.html", viewport=PHONE, is_mobile=True, has_touch=True)
    page.wait_for_timeout(500)
    width = page.evaluate("document.documentElement.scrollWidth")
    too_wide = page.evaluate(
        """limit => [...document.querySelectorAll('article *')]
            .filter(e => e.getBoundingClientRect().right > limit + 1)
            .filter(e => !e.closest('pre, table, .math, mjx-container, .cell_output'))
            .map(e => e.outerHTML.slice(0, 120))""",
        PHONE["width"],
    )
    assert width <= PHONE["width"]
    assert too_wide == []


@pytest.mark.parametrize("name", NAMES[1:])
def test_every_figure_loads(visit, name):
    page = visit(f"{name}.html")
    broken = page.evaluate(
        "[...document.images].filter(i => !i.complete || !i.naturalWidth).map(i => i.src)"
    )
    assert broken == []


def test_search_finds_a_word_that_only_some_lessons_have(visit):
    page = visit("index.html")
    page.locator(".sidebar-search").fill("jacobian")
    page.locator(".sidebar-search").press("Enter")
    page.wait_for_selector("#search-results li a")
    found = page.locator("#search-results li a").evaluate_all("links => links.map(a => a.href)")
    assert any("01b_inverse.html" in link for link in found)


def test_theme_switches_between_light_and_dark(visit):
    page = visit("index.html", color_scheme="light")

    def brightness():
        colour = page.evaluate("getComputedStyle(document.body).backgroundColor")
        return sum(map(int, re.findall(r"\d+", colour)[:3]))

    seen = {brightness()}
    for _ in range(3):
        page.locator(".theme-toggle").locator("visible=true").first.click()
        seen.add(brightness())
    assert min(seen) < 150 and max(seen) > 700


def test_dark_mode_follows_the_system(visit):
    page = visit("index.html", color_scheme="dark")
    colour = page.evaluate("getComputedStyle(document.body).backgroundColor")
    assert sum(map(int, re.findall(r"\d+", colour)[:3])) < 150


def test_every_lesson_is_a_click_away_from_the_start(visit):
    page = visit("index.html")
    for name in NAMES[1:]:
        page.locator(f".sidebar-tree a[href='{name}.html']").click()
        page.wait_for_url(f"**/{name}.html")
        assert page.locator("article h1").count() == 1


def test_an_answer_is_behind_a_button_that_the_keyboard_reaches_and_on_paper(visit):
    page = visit("00_tour.html")
    answer = page.locator(".answer-text").first
    assert not answer.is_visible()
    assert page.locator(".answer-button").count() == page.locator(".answer-text").count() >= 3
    page.locator(".answer-box").first.focus()
    page.keyboard.press("Space")
    assert answer.is_visible()
    page.keyboard.press("Space")
    assert not answer.is_visible()
    page.emulate_media(media="print")
    assert all(one.is_visible() for one in page.locator(".answer-text").all())


def test_replay_plays(visit):
    page = visit("00_tour.html")
    for box in page.locator(".answer-box").all():
        box.check(force=True)
    frame = page.locator("iframe").first
    frame.scroll_into_view_if_needed()
    player = frame.content_frame
    player.get_by_label("Time", exact=True).wait_for()
    before = float(player.get_by_label("Time", exact=True).input_value())
    player.get_by_role("button", name="Play", exact=True).first.click()
    for _ in range(100):
        after = float(player.get_by_label("Time", exact=True).input_value())
        if after > before + 0.5:
            return
        page.wait_for_timeout(100)
    pytest.fail(f"the replay's time stays at {after} s after Play")


def test_figures_stand_on_the_dark_page_without_a_white_slab(visit):
    page = visit("02a_gravity.html", color_scheme="dark")
    backgrounds = page.locator(".cell_output img").evaluate_all(
        "all => all.map(image => getComputedStyle(image).backgroundColor)"
    )
    assert set(backgrounds) == {"rgba(0, 0, 0, 0)"}
