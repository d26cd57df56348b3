"""Chromium for the browser tests; without it they are skipped, in CI they fail."""

import os
import shutil

import pytest

FLAGS = [
    "--no-sandbox",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--use-angle=swiftshader",  # WebGL on the processor, for machines without a GPU
    "--enable-unsafe-swiftshader",
]
NAMES = ("chromium", "chromium-browser", "google-chrome", "chrome")


def pytest_collection_modifyitems(items):
    for item in items:
        if item.path.parent.name == "browser":
            item.add_marker(pytest.mark.browser)


def _without(what):
    if os.environ.get("CI") == "true":
        pytest.fail(f"{what} is missing, and in CI the browser tests must run")
    pytest.skip(f"{what} is missing: install it to run the browser tests")


@pytest.fixture(scope="session")
def chromium():
    try:
        from playwright.sync_api import sync_playwright
    except ImportError:
        _without("the package playwright")
    program = next(filter(None, map(shutil.which, NAMES)), None)
    if program is None:
        _without("Chromium")
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=program, args=FLAGS)
        yield browser
        browser.close()
