"""Import packages in less time: without pandas, which others import if they find it, and without garbage collection."""

from __future__ import annotations

import gc
import sys
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def quick_imports() -> Iterator[None]:
    """Import in the block between `begin_imports` and `end_imports`; where the collector is off, nothing is changed."""
    if not gc.isenabled():  # such as in another block
        yield
        return
    begin_imports()
    try:
        yield
    finally:
        end_imports()


def begin_imports() -> None:
    """Let imports find no pandas, unless pandas is imported already, and stop the garbage collector.

    Scikit-learn and pyarrow work without pandas, but import pandas if they find it. The collector would look through the
    imported modules again and again.
    """
    gc.disable()
    if "pandas" not in sys.modules and _NoPandas not in sys.meta_path:
        sys.meta_path.insert(0, _NoPandas)


def end_imports() -> None:
    """Undo `begin_imports`: later imports of pandas work as usual."""
    if _NoPandas in sys.meta_path:
        sys.meta_path.remove(_NoPandas)
    gc.enable()


def keep_pandas_out() -> None:
    """Make the first array of pyarrow, which imports pandas if there is any."""
    import pyarrow as pa

    with quick_imports():
        pa.array([0])


class _NoPandas:
    """A finder for `sys.meta_path` that raises `ModuleNotFoundError` for pandas."""

    @staticmethod
    def find_spec(name: str, *_: object) -> None:
        if name == "pandas":
            raise ModuleNotFoundError(name=name)
