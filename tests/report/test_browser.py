"""The page in a real browser, where there is one."""

import shutil
import subprocess

import pytest
from report.pages import read_page
from report.synthetic import OBJECTS, PARAMETERS, write_run

from visuohaptic.report import make_report

BROWSER = next(
    filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), ""
)


@pytest.fixture(scope="module")
def opened(tmp_path_factory):
    if not BROWSER:
        pytest.skip("no Chromium on this machine (Debian, Ubuntu: apt install chromium)")
    folder = tmp_path_factory.mktemp("browser")
    make_report(write_run(folder), folder / "report.html", PARAMETERS, OBJECTS)
    options = ["--headless", "--no-sandbox", "--disable-gpu", "--no-first-run", "--disable-sync"]
    options += ["--disable-background-networking", "--disable-component-update"]
    options += [f"--user-data-dir={folder / 'profile'}", "--enable-logging=stderr", "--dump-dom"]
    return subprocess.run(
        [BROWSER, *options, f"file://{folder / 'report.html'}"],
        capture_output=True,
        text=True,
        timeout=120,
        check=True,
    )


def test_the_script_runs_and_offers_what_needs_it(opened):
    page = read_page(opened.stdout)
    buttons = [e for e in page.named("button") if e.attributes.get("class") == "open"]
    assert len(buttons) == len(OBJECTS)
    assert not any("hidden" in element.attributes for element in buttons)
    filters = [e for e in page.named("p") if e.attributes.get("class") == "filter"]
    assert not any("hidden" in element.attributes for element in filters)


def test_the_console_stays_silent(opened):
    assert [line for line in opened.stderr.splitlines() if "CONSOLE" in line] == []
