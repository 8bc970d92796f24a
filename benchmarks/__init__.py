"""Compare run times with other packages. Errors are measured against the references of the tests."""

import sys
from pathlib import Path

ROOT = Path(__file__).parent.parent
FOLDERS = ("studies", "tests", "packages/contourlets/tests", "packages/meshreaders/tests")
sys.path += [str(ROOT / folder) for folder in FOLDERS]
