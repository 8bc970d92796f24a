"""Crop the README's picture out of the report of the last run: `python docs/make_overview_picture.py`."""

from __future__ import annotations

import io
import shutil
from pathlib import Path

from PIL import Image, ImageOps
from playwright.sync_api import sync_playwright

ROOT = Path(__file__).parents[1]
PICTURE = ROOT / "docs" / "pictures" / "overview.png"
SECTION = "#method .flow"
WIDTH = 1180
MARGIN = 32
LARGEST_BYTES = 400_000


def photograph(report: Path) -> Image.Image:
    """Photograph the section of a report that shows the method on one object, with a margin, two pixels for one."""
    browser_path = shutil.which("chromium") or shutil.which("google-chrome")
    if browser_path is None:
        raise SystemExit("There is no Chromium here (Debian, Ubuntu: apt install chromium).")
    with sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=browser_path, args=["--no-sandbox"])
        page = browser.new_page(
            viewport={"width": WIDTH, "height": 900}, device_scale_factor=2, color_scheme="light"
        )
        page.goto(report.resolve().as_uri())
        png = page.locator(SECTION).screenshot()
        browser.close()
    section = Image.open(io.BytesIO(png)).convert("RGB")
    return ImageOps.expand(section, MARGIN, section.getpixel((0, section.height - 1)))


if __name__ == "__main__":
    photograph(ROOT / "reports" / "report.html").save(PICTURE, optimize=True)
    size = PICTURE.stat().st_size
    if size > LARGEST_BYTES:
        raise SystemExit(f"{PICTURE} has {size} bytes; {LARGEST_BYTES} are allowed.")
