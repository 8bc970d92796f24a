"""Chromium as the system brings it, driven by Playwright; screenshots are kept for a look."""

import shutil
from pathlib import Path

import pytest

SCREENSHOTS = Path(__file__).parents[2] / "reports" / "screenshots"
BROWSER = next(
    filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None
)
# A sandbox needs more than a container gives. Pages draw without WebGL, so nothing renders 3D in software.
OPTIONS = ["--no-sandbox", "--disable-gpu"]
PHONE = {"width": 390, "height": 844}
DESK = {"width": 1280, "height": 900}
OWN = ("file:", "data:", "blob:")


def watch(page):
    """List what should not happen on a page: errors, dialogs, and requests that leave it."""
    unwanted = []

    def dismiss(dialog):
        unwanted.append(dialog.message)
        dialog.dismiss()

    def note_error(said):
        if said.type == "error":
            unwanted.append(said.text)

    def note_request(asked):
        if not asked.url.startswith(OWN):
            unwanted.append(asked.url[:100])

    page.on("dialog", dismiss)
    page.on("pageerror", lambda error: unwanted.append(str(error)))
    page.on("console", note_error)
    page.on("request", note_request)
    return unwanted


@pytest.fixture(scope="module")
def chromium():
    """One browser for all pages of a module."""
    if BROWSER is None:
        pytest.skip(
            "no Chromium here, so no page was opened (Debian, Ubuntu: apt install chromium)"
        )
    from playwright.sync_api import sync_playwright

    with sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=BROWSER, args=OPTIONS)
        yield browser
        browser.close()


@pytest.fixture(scope="module")
def visit(chromium):
    """Open a page as a reader would: light or dark, on a desk or a phone, with scripts or without."""
    opened = []

    def open_page(path, scheme="light", viewport=DESK, scripts=True):
        context = chromium.new_context(
            color_scheme=scheme,
            viewport=viewport,
            java_script_enabled=scripts,
            reduced_motion="reduce",
        )
        page = context.new_page()
        opened.append((path.name, scheme, watch(page)))
        page.goto(path.as_uri())
        return page

    yield open_page
    assert [one for one in opened if one[-1]] == []


@pytest.fixture(scope="session")
def keep():
    """Keep a screenshot."""
    SCREENSHOTS.mkdir(parents=True, exist_ok=True)

    def shoot(shown, name, **options):
        shown.screenshot(path=SCREENSHOTS / f"{name}.png", **options)

    return shoot
