"""Draws of random places that are kept with the package."""

import itertools
import json

import numpy as np
import pytest

from visuohaptic.base.errors import ReportError
from visuohaptic.report.draws import kept_sentence, read_draws, read_kept

KEPT = {
    "paper": {
        "commit": "0123456789abcdef",
        "date": "2026-11-26",
        "objects": ["box/a", "box/b", "cup/c"],
        "pipelines": {
            "order_free": {
                "classifier": "linear_discriminant",
                "weights": [1.0, 3.0, 4.0],
                "fixation": [1.0, 0.5, 1.0],
                "draws": {"random": [[1.0, 0.5, 0.9], [0.5, 0.5, 1.0], [1.0, None, 1.0]]},
            }
        },
    }
}


@pytest.fixture
def path(tmp_path):
    path = tmp_path / "draws.json"
    path.write_text(json.dumps(KEPT))
    return path


def test_leads_over_kept_draws_are_weighted_means_over_the_objects_of_both(path):
    found = read_draws("paper", "order_free", path)
    leads = (0.4 / 8, 0.5 / 8, 0.0)
    assert found.lead.leads == pytest.approx(leads)
    assert found.lead.standard_deviation == pytest.approx(np.std(leads, ddof=1))
    assert found.fixation == pytest.approx((1 + 1.5 + 4) / 8)
    assert (found.objects, found.lead.count) == (3, 3)


def test_the_sentence_names_the_set_the_commit_both_ends_and_the_spread(path):
    assert kept_sentence(read_draws("paper", "order_free", path)) == (
        "In 3 draws of random places that are kept with the package (3 objects of set paper, pipeline order_free, linear "
        "discriminant, default parameters, commit 0123456789ab) the lead of fixation lies between "
        "+0.0 and +6.2 points, standard deviation 3.3."
    )


def test_what_is_not_kept_is_none_and_a_damaged_file_is_named(path):
    assert read_draws("paper", "paper", path) is None
    assert read_draws("benchmark", "order_free", path) is None
    path.write_text('{"paper": {}}')
    with pytest.raises(ReportError, match=r"draws.json holds no kept draws .*make draws"):
        read_draws("paper", "order_free", path)


def test_the_kept_draws_of_the_package_can_be_read():
    for name, kept in read_kept().items():
        for pipeline, opponent in itertools.product(kept.pipelines, ("random", "random_visible")):
            drawn = read_draws(name, pipeline, opponent=opponent)
            assert drawn.lead.count == (5 if pipeline == "literal" else 20)
