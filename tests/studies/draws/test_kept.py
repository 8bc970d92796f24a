"""Leads over kept draws of random places, and the sentence on them."""

import itertools

import numpy as np
import pytest
from studies.kept_tables import write_kept

from draws.kept import kept_sentence, read_draws, read_kept
from draws.tables import DRAWS
from visuohaptic.base.errors import ReportError
from visuohaptic.studies.keeping import kept_file
from visuohaptic.tables.schema import build_rows

OBJECTS = {"box/a": 1.0, "box/b": 3.0, "cup/c": 4.0}
"""Weights by object."""
ACCURACIES = {
    ("fixation", 0): (1.0, 0.5, 1.0),
    ("random", 0): (1.0, 0.5, 0.9),
    ("random", 1): (0.5, 0.5, 1.0),
    ("random", 2): (1.0, None, 1.0),
}
ROWS = [
    {
        "pipeline": "order_free", "strategy": strategy, "classifier": "linear_discriminant", "draw": draw,
        "class": owner.split("/")[0], "object": owner.split("/")[1], "accuracy": accuracy, "weight": weight,
    }
    for (strategy, draw), accuracies in ACCURACIES.items()
    for (owner, weight), accuracy in zip(OBJECTS.items(), accuracies, strict=True)
    if accuracy is not None
]  # fmt: skip


@pytest.fixture
def folder(tmp_path):
    """A folder with kept draws of set paper."""
    write_kept(build_rows(DRAWS, ROWS), tmp_path, "paper", "0123456789abcdef", "2026-11-26")
    return tmp_path


def test_leads_over_kept_draws_are_weighted_means_over_the_objects_of_both(folder):
    found = read_draws("paper", "order_free", folder)
    leads = (0.4 / 8, 0.5 / 8, 0.0)
    assert found.lead.leads == pytest.approx(leads)
    assert found.lead.standard_deviation == pytest.approx(np.std(leads, ddof=1))
    assert (found.objects, found.lead.count) == (3, 3)


def test_the_sentence_names_the_set_the_commit_both_ends_and_the_spread(folder):
    assert kept_sentence(read_draws("paper", "order_free", folder)) == (
        "In 3 draws of random places that are kept with the study (3 objects of set paper, pipeline order_free, linear "
        "discriminant, default parameters, commit 0123456789ab) the lead of fixation lies between "
        "+0.0 and +6.2 points, standard deviation 3.3."
    )


def test_what_is_not_kept_is_none_and_a_damaged_file_is_named(folder):
    assert read_draws("paper", "paper", folder) is None
    assert read_draws("benchmark", "order_free", folder) is None
    assert read_draws("paper", "order_free", folder, "random_visible") is None
    kept_file(folder, "paper").write_text("no table")
    with pytest.raises(
        ReportError, match=r"kept_paper.parquet holds no result of study draws .*make draws"
    ):
        read_draws("paper", "order_free", folder)


def test_the_kept_draws_of_the_study_are_complete():
    assert set(read_kept()) == {"paper", "benchmark"}
    for name, kept in read_kept().items():
        assert kept.source.set == name
        for pipeline, opponent in itertools.product(kept.pipelines, ("random", "random_visible")):
            drawn = read_draws(name, pipeline, opponent=opponent)
            assert drawn.lead.count == (5 if pipeline == "literal" else 20)
