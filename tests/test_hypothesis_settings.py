"""The outcome of a Hypothesis test depends neither on time nor on the tests that ran before in the same process."""

import importlib
import itertools
import sys
import time

from hypothesis import given
from hypothesis import strategies as st


def drawn_examples():
    """Return the examples of a test, in order."""
    examples = []

    @given(st.tuples(st.floats(), st.integers(), st.text("abc", max_size=3)))
    def collect(example):
        examples.append(repr(example))

    collect()
    return examples


def test_a_machine_that_stalls_is_no_failure(monkeypatch):
    # An hour passes between any two looks at the clock.
    monkeypatch.setattr(time, "perf_counter", itertools.count(0.0, 3600.0).__next__)
    assert len(drawn_examples()) > 10


def test_examples_stay_the_same_after_an_import(tmp_path, monkeypatch):
    before = drawn_examples()
    numbers = ", ".join(f"{number}.5, {number}" for number in range(1000, 1100))
    (tmp_path / "constants_of_a_project.py").write_text(
        f"NUMBERS = {numbers}\nTEXTS = 'ab', 'ca'\n"
    )
    monkeypatch.syspath_prepend(tmp_path)
    importlib.import_module("constants_of_a_project")
    try:
        assert drawn_examples() == before
    finally:
        del sys.modules["constants_of_a_project"]
