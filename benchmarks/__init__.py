"""Compare run times with other packages. Errors are measured against the references of the tests."""

import sys
from pathlib import Path

ROOT = Path(__file__).parent.parent
sys.path += [str(ROOT / "tests"), str(ROOT / "packages/contourlets/tests")]
