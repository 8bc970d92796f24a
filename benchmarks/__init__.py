"""Timings side by side with peers; not tests, but errors are against the right answers that the tests have."""

import sys
from pathlib import Path

ROOT = Path(__file__).parent.parent
sys.path += [str(ROOT / "tests"), str(ROOT / "packages/contourlets/tests")]
