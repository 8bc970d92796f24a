"""Chromium as the system brings it, driven by Playwright; screenshots are kept for a look."""

import shutil
from dataclasses import dataclass, field
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
SCREENSHOTS = ROOT / "reports" / "screenshots"
BROWSER = next(
    filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None
)
# A sandbox needs more than a container gives; drawing in 3D needs no graphics card.
OPTIONS = [
    "--no-sandbox",
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--ignore-gpu-blocklist",
]
PHONE = {"width": 390, "height": 844}
DESK = {"width": 1280, "height": 900}


@dataclass
class Watched:
    """A page, and everything that should not have happened on it."""

    page: object
    complaints: list = field(default_factory=list)
    requests: list = field(default_factory=list)
    dialogs: list = field(default_factory=list)

    def watch(self):
        self.page.on("pageerror", lambda error: self.complaints.append(str(error)))
        self.page.on(
            "console",
            lambda said: self.complaints.append(said.text) if said.type == "error" else None,
        )
        self.page.on("request", lambda asked: self.requests.append(asked.url))
        self.page.on("dialog", self._dismiss)

    def _dismiss(self, dialog):
        self.dialogs.append(dialog.message)
        dialog.dismiss()

    @property
    def outside(self):
        """Requests that left the page."""
        own = ("file:", "data:", "blob:")
        return [url[:100] for url in self.requests if not url.startswith(own)]


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


@pytest.fixture
def visit(chromium):
    """Open a page as a reader would: light or dark, on a desk or a phone, with scripts or without."""
    contexts = []

    def open_page(path, scheme="light", viewport=None, scripts=True):
        context = chromium.new_context(
            color_scheme=scheme,
            viewport=viewport or DESK,
            java_script_enabled=scripts,
            reduced_motion="reduce",
        )
        contexts.append(context)
        watched = Watched(context.new_page())
        watched.watch()
        watched.page.goto(path.as_uri())
        return watched

    yield open_page
    for context in contexts:
        context.close()


@pytest.fixture(scope="session")
def keep():
    """Keep a screenshot."""
    SCREENSHOTS.mkdir(parents=True, exist_ok=True)

    def shoot(shown, name, **options):
        shown.screenshot(path=SCREENSHOTS / f"{name}.png", **options)

    return shoot
