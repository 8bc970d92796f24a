"""Packages that import pandas only if they find it are imported without it, and pandas can be imported later."""

import gc
import subprocess
import sys

import pytest
from source_folders import PYTHONPATH

from visuohaptic.base.quick_imports import quick_imports

PROGRAM = """
import gc, sys
from visuohaptic.base.quick_imports import quick_imports

with quick_imports():
    import sklearn.svm
    assert not gc.isenabled()
assert "pandas" not in sys.modules
assert gc.isenabled()
import pandas
assert pandas.DataFrame({"a": [1]}).shape == (1, 1)
with quick_imports():
    import pandas as again
assert again is pandas
"""


def test_scikit_learn_is_imported_without_pandas_which_works_later():
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM], check=False, env={"PYTHONPATH": PYTHONPATH},
        text=True, capture_output=True,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr


def test_after_an_error_all_is_as_before():
    finders = [*sys.meta_path]
    with pytest.raises(ZeroDivisionError), quick_imports():
        raise ZeroDivisionError
    assert gc.isenabled()
    assert sys.meta_path == finders


def test_a_block_inside_another_leaves_the_end_to_the_outer_one():
    with quick_imports():
        finders = [*sys.meta_path]
        with quick_imports():
            pass
        assert (gc.isenabled(), sys.meta_path) == (False, finders)
    assert gc.isenabled()
