"""Every hard case is within its tolerance, and an error in what a check is about is found."""

import inspect

import numpy as np
import pyarrow as pa
import pytest
from numerics.checks import CHECKS, holds, run_check
from numerics.hard_cases import learning, meshes
from stability.errors import plant

from visuohaptic.parameters import ExperimentParameters

SEED = ExperimentParameters().seed


@pytest.mark.parametrize("check", CHECKS.values(), ids=CHECKS)
def test_every_case_is_within_its_tolerance(recorder, full, check):
    recorder.keep(run_check(check, SEED, check.full_draws if full else check.draws).values())


@pytest.mark.slow
@pytest.mark.parametrize("name", [name for name, check in CHECKS.items() if check.about])
def test_an_error_in_what_is_checked_is_found(monkeypatch, no_caches, name):
    check = CHECKS[name]
    plant(monkeypatch, inspect.getmodule(check.measure), check.about)
    assert not holds(check, 1, check.draws)


@pytest.mark.parametrize("stable", [True, False])
def test_answers_that_rounding_changes_are_found(monkeypatch, stable):
    def predict_sequences(training, labels, tested, classifier):
        decided_by = tested.sum(axis=(1, 2))
        return tested, np.rint(decided_by if stable else decided_by * 2**50).astype(int) % 2

    monkeypatch.setattr(learning, "predict_sequences", predict_sequences)
    assert holds(CHECKS["rounding"], 1, 2) == stable


def test_a_chain_that_ends_without_features_is_found(monkeypatch):
    monkeypatch.setattr(meshes, "run_chain", lambda *_: {"features": pa.table({"x": []})})
    assert not holds(CHECKS["wild_surfaces"], 1, 1)


def test_the_same_seed_draws_the_same_cases():
    check = CHECKS["sequence_moments"]
    assert run_check(check, 5, 3) == run_check(check, 5, 3)
    assert run_check(check, 5, 3) != run_check(check, 6, 3)
