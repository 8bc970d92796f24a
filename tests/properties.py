"""Hypothesis for tests; where it is not installed, the tests that need it are skipped and the others run."""

import pytest

try:
    from hypothesis import given, settings
    from hypothesis import strategies as st
    from hypothesis.extra.numpy import arrays
except ModuleNotFoundError:
    _REASON = "hypothesis is not installed: pip install -e '.[dev]'"

    class _Strategy:
        """Stands where a strategy is described, and draws nothing."""

        def __getattr__(self, name):
            return self

        def __call__(self, *arguments, **named):
            return self

        def __or__(self, other):
            return self

    def given(*strategies, **named):
        return pytest.mark.skip(reason=_REASON)

    def settings(**named):
        return lambda test: test

    st = arrays = _Strategy()

__all__ = ["arrays", "given", "settings", "st"]
