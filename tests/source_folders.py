"""The folders that hold this repository's packages, for processes that tests start."""

import os
from pathlib import Path

ROOT = Path(__file__).parents[1]
SOURCES = [ROOT / "src", ROOT / "packages/contourlets/src", ROOT / "workflow/lib", ROOT / "studies"]
PYTHONPATH = os.pathsep.join(map(str, SOURCES))
