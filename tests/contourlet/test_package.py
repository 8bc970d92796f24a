import subprocess
import sys
from pathlib import Path

from visuohaptic import contourlet

FOLDER = Path(contourlet.__file__).parent


def test_package_mentions_images_only():
    for path in FOLDER.glob("*.py*"):
        text = path.read_text(encoding="utf-8").lower()
        assert not any(word in text for word in ("touch", "tactile", "imprint", "taxel")), path


def test_deviations_load_nothing_heavy():
    program = (
        "import sys, numpy; from visuohaptic.contourlet import directional_deviations;"
        "directional_deviations(numpy.zeros((1, 32, 32)));"
        "sys.exit(any(m in sys.modules for m in ('sklearn', 'scipy', 'pywt', 'pandas')))"
    )
    subprocess.run(
        [sys.executable, "-c", program], env={"PYTHONPATH": ":".join(sys.path)}, check=True
    )
