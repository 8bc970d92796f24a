import doctest
import importlib
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import contourlets
from contourlets import FilterError, pyramid_filter_names, pyramid_filters, wavelet_deviations

FOLDER = Path(contourlets.__file__).parent
MODULES = sorted(path.stem for path in FOLDER.glob("[!_]*.py"))


def test_package_mentions_images_only():
    for path in FOLDER.glob("*.py"):
        text = path.read_text(encoding="utf-8").lower()
        words = ("touch", "tactile", "imprint", "taxel", "haptic")
        assert not any(word in text for word in words), path


def test_deviations_load_numpy_alone():
    program = (
        "import sys, numpy; from contourlets import directional_deviations;"
        "directional_deviations(numpy.zeros((1, 32, 32)));"
        "sys.exit(any(m in sys.modules for m in ('sklearn', 'scipy', 'pywt', 'pandas')))"
    )
    subprocess.run(
        [sys.executable, "-c", program], env={"PYTHONPATH": ":".join(sys.path)}, check=True
    )


def test_without_pywavelets_its_filters_are_refused_in_one_sentence(monkeypatch):
    monkeypatch.setitem(sys.modules, "pywt", None)
    pyramid_filters.cache_clear()
    assert pyramid_filter_names() == ("9-7", "5-3", "haar")
    assert len(pyramid_filters("9-7").analysis) == 9
    for ask in (
        lambda: pyramid_filters("bior4.4"),
        lambda: wavelet_deviations(np.zeros((1, 32, 32))),
    ):
        with pytest.raises(FilterError, match=r"PyWavelets, which is not installed; `pip install"):
            ask()


@pytest.mark.parametrize("module", MODULES)
def test_examples_in_docstrings_run(module):
    assert doctest.testmod(importlib.import_module(f"contourlets.{module}")).failed == 0
