"""The folders that hold this repository's packages and installed ones, for processes that tests start."""

import os
from importlib.metadata import distribution
from pathlib import Path

from packaging.requirements import Requirement

ROOT = Path(__file__).parents[1]
SOURCES = [
    ROOT / "src",
    ROOT / "packages/contourlets/src",
    ROOT / "packages/meshreaders/src",
    ROOT / "workflow/lib",
    ROOT / "studies",
]
PYTHONPATH = os.pathsep.join(map(str, SOURCES))


def link_installed(requirements, folder, known=()):
    """Link the distributions that are required, and those that they require, into a folder."""
    waiting, linked = [Requirement(line) for line in requirements], {*known}
    while waiting:
        requirement = waiting.pop()
        marker = requirement.marker
        if requirement.name.lower() in linked or (marker and not marker.evaluate({"extra": ""})):
            continue
        linked.add(requirement.name.lower())
        installed = distribution(requirement.name)
        waiting += map(Requirement, installed.requires or [])
        for top in {file.parts[0] for file in installed.files or []} - {"..", "__pycache__"}:
            if not (folder / top).exists():
                (folder / top).symlink_to(installed.locate_file(top))
