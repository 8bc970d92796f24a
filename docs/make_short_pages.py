"""Run the code of the short pages, and keep the pictures that the code saves: `python docs/make_short_pages.py`."""

from __future__ import annotations

import contextlib
import io
import os
import re
import shutil
import tempfile
from pathlib import Path

import trimesh

DOCS = Path(__file__).parent
ROOT = DOCS.parent
PICTURES = DOCS / "pictures"
PAGES = ("own_data_set", "own_policy", "own_classifier", "press_a_grid", "plot_a_sequence")
"""The pages in order: the third reads a file that the first writes."""


def make_folder(folder: Path) -> None:
    """Write the files that the pages read: nine meshes of three classes with z up, and the paper's objects."""
    for kind, make in {"bottle": bottle, "mug": mug, "table": table}.items():
        (folder / "things" / kind).mkdir(parents=True)
        for number, width in enumerate((0.8, 1.0, 1.3)):
            make(width).export(folder / "things" / kind / f"{kind}{number}.stl")
    (folder / "meshes").symlink_to(ROOT / "meshes")


def bottle(width: float) -> trimesh.Trimesh:
    """Return a bottle 120 mm high, z up; `width` is a factor."""
    profile = [[0, 0], [25, 0], [25, 70], [10, 90], [10, 120], [0, 120]]
    mesh = trimesh.creation.revolve(profile, sections=48)
    return mesh.apply_scale([width, width, 1])


def mug(width: float) -> trimesh.Trimesh:
    """Return a mug 80 mm high with its handle at x, z up; `width` is a factor."""
    cup = trimesh.creation.annulus(32, 40, 80).apply_scale([width, width, 1])
    base = trimesh.creation.cylinder(33 * width, 6).apply_translation([0, 0, -37])
    handle = trimesh.creation.torus(20, 5).apply_transform(
        [[1, 0, 0, 40 * width + 12], [0, 0, -1, 0], [0, 1, 0, 0], [0, 0, 0, 1]]
    )
    return trimesh.util.concatenate([cup, base, handle])


def table(width: float) -> trimesh.Trimesh:
    """Return a table 75 cm high with four legs, z up; `width` is a factor."""
    parts = [trimesh.creation.box((120 * width, 70, 4)).apply_translation([0, 0, 73])]
    for x in (-55 * width, 55 * width):
        for y in (-30, 30):
            leg = trimesh.creation.box((6, 6, 71))
            parts.append(leg.apply_translation([x, y, 35.5]))
    return trimesh.util.concatenate(parts)


def code_of(name: str) -> str:
    """Return the Python of a page."""
    text = (DOCS / f"{name}.md").read_text(encoding="utf-8")
    return "\n".join(re.findall(r"^```python\n(.*?)^```", text, re.M | re.S))


def run_page(name: str, folder: Path) -> str:
    """Run the Python of a page in a folder of `make_folder`, and return what it prints."""
    printed, before = io.StringIO(), Path.cwd()
    os.chdir(folder)
    try:
        with contextlib.redirect_stdout(printed):
            exec(compile(code_of(name), f"{name}.md", "exec"), {})  # noqa: S102
    finally:
        os.chdir(before)
    return printed.getvalue()


def main() -> None:
    """Run all pages, print what they print, and keep their pictures."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        make_folder(folder)
        for page in PAGES:
            print(f"{page}:\n{run_page(page, folder)}")
            shutil.copy(folder / f"{page}.png", PICTURES / f"{page}.png")


if __name__ == "__main__":
    main()
