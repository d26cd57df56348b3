"""The exported pages as files: complete, readable without sight or network, small."""

import re
from functools import cache
from html.parser import HTMLParser
from pathlib import Path

import pytest

from backhoe import __main__
from backhoe.course import site, workspace

STEMS = sorted(path.stem for path in workspace.root().glob("notebooks/*.ipynb"))
LOADING = {"script": "src", "img": "src", "iframe": "src", "source": "src", "video": "src"}


class Page(HTMLParser):
    """Every start tag of a page with its attributes, and the text of its title."""

    def __init__(self, path):
        super().__init__()
        self.path, self.tags, self.title, self._in_title = path, [], "", False
        self.feed(path.read_text(encoding="utf-8"))

    def handle_starttag(self, tag, attributes):
        self.tags.append((tag, dict(attributes)))
        self._in_title = tag == "title" and not self.title

    def handle_endtag(self, tag):
        self._in_title = False

    def handle_data(self, data):
        if self._in_title:
            self.title += data

    def all(self, *names):
        return [attributes for tag, attributes in self.tags if tag in names]

    def loads(self):
        """What the browser fetches to show the page."""
        found = [a[LOADING[t]] for t, a in self.tags if LOADING.get(t) in a]
        kinds = ("stylesheet", "icon", "preload", "modulepreload")
        return found + [a["href"] for a in self.all("link") if a.get("rel", "") in kinds]


@pytest.fixture(scope="module")
def pages(tmp_path_factory):
    return site.build(tmp_path_factory.mktemp("site") / "lessons")


@pytest.fixture(params=["index", *STEMS])
def page(pages, request):
    return Page(pages / f"{request.param}.html")


def _local(page, link):
    path, _, anchor = link.partition("#")
    return (page.path.parent / path.partition("?")[0] if path else page.path), anchor


@cache
def _anchors(path):
    return {attributes.get("id") for _, attributes in Page(path).tags}


def test_every_notebook_has_a_page(pages):
    assert {path.stem for path in pages.glob("[0-9]*.html")} == set(STEMS)


def test_page_has_a_language_a_title_and_a_viewport(page):
    assert page.all("html")[0]["lang"] == "en"
    assert page.title.endswith("Backhoe")
    assert any("width=device-width" in a.get("content", "") for a in page.all("meta"))


def test_page_loads_only_what_lies_beside_it(page):
    for link in page.loads():
        assert not re.match(r"(\w+:)?//", link), link
        if not link.startswith("data:"):
            assert _local(page, link)[0].is_file(), link


def test_no_link_inside_the_site_is_broken(page):
    for a in page.all("a"):
        link = a.get("href", "")
        if not link or re.match(r"\w+:", link):
            continue
        path, anchor = _local(page, link)
        assert path.is_file(), link
        if anchor and anchor != "top":
            assert anchor in _anchors(path), link


def test_every_image_says_what_it_shows(page):
    for image in page.all("img"):
        text = image.get("alt", "")
        assert len(text.split()) >= 4, image
        assert not text.endswith(".png")


def test_every_frame_has_a_title_and_its_page_inside(page):
    for frame in page.all("iframe"):
        assert len(frame.get("title", "")) > 10
        assert frame["srcdoc"].startswith("<!doctype html>")
        assert not re.search(r"(src|href)=\"?(https?:)?//", frame["srcdoc"])


def test_no_widget_is_left_without_its_picture(page):
    text = page.path.read_text(encoding="utf-8")
    assert "vnd.jupyter.widget" not in text
    assert "interactive(children" not in text


@pytest.mark.parametrize("stem", STEMS)
def test_lesson_stays_within_its_size(pages, stem):
    page = Page(pages / f"{stem}.html")
    pictures = {_local(page, image["src"])[0] for image in page.all("img")}
    size = page.path.stat().st_size + sum(picture.stat().st_size for picture in pictures)
    assert size <= 1.5e6


def test_search_index_holds_every_lesson(pages):
    index = (pages / "searchindex.js").read_text(encoding="utf-8")
    assert all(f'"{stem}"' in index for stem in STEMS)


def test_export_replaces_an_earlier_one_and_nothing_else(pages, tmp_path):
    other = tmp_path / "thesis"
    other.mkdir()
    (other / "chapter.txt").write_text("mine", encoding="utf-8")
    with pytest.raises(FileExistsError, match="name an empty or a new folder"):
        site.build(other)
    assert (other / "chapter.txt").read_text(encoding="utf-8") == "mine"
    (pages / "old.html").write_text("old", encoding="utf-8")
    site.build(pages)
    assert not (pages / "old.html").exists()


def test_missing_sphinx_is_named_with_its_fix(monkeypatch, capsys):
    monkeypatch.setattr(site.importlib.util, "find_spec", lambda name: None)
    with pytest.raises(ModuleNotFoundError, match="sphinx, myst-nb, furo"):
        site.build()
    assert __main__.main(["lessons"]) == 1
    assert "requirements-dev.txt" in capsys.readouterr().err


def test_broken_link_stops_the_export(monkeypatch, tmp_path):
    folder = tmp_path / "notebooks"
    folder.mkdir()
    for name in ("conf.py", "_static"):
        (folder / name).symlink_to(workspace.root() / "notebooks" / name)
    text = "# Start\n\n[gone](missing.md)\n"
    (folder / "index.md").write_text(text, encoding="utf-8")
    monkeypatch.setattr(site, "root", lambda: tmp_path)
    with pytest.raises(RuntimeError, match=r"missing\.md"):
        site.build(tmp_path / "pages")
    assert not Path(tmp_path, "pages").exists()


def test_the_front_page_opens_with_the_machine_alone(pages):
    """The replay of the whole mission, as its sitting has it."""
    front, sitting = (
        Page(pages / f"{name}.html").all("iframe") for name in ("index", "14b_report")
    )
    assert len(front) == 1 and front[0]["srcdoc"] and front[0] == sitting[0]
