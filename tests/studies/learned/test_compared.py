"""Gains and leads from accuracies of objects: who is compared with whom, and which set of settings is corrected for."""

from itertools import product

import numpy as np
import pandas as pd
import pytest

from learned import compared
from learned.compared import ComparedSetting, Gains, answers_of, kept_of_all, leads_of
from learned.study import FRAMES, LONG, PIPELINES, STRATEGIES
from visuohaptic.evaluation.intervals import compare_paired, holm
from visuohaptic.recognition.parameters import IntervalParameters

OBJECTS = [f"c{number % 3}/o{number}" for number in range(12)]
SETTINGS = [*product(FRAMES, STRATEGIES, PIPELINES)]


def rows_of(shares, touches=5, views=1):
    """Rows of all objects, by accuracies (s, o) of the settings."""
    return pd.DataFrame(
        [
            {
                "turns": "none", "frame": frame, "touches": touches, "views": views,
                "pipeline": pipeline, "strategy": strategy, "object": name,
                "accuracy": accuracy, "weight": 1.0,
            }
            for (frame, strategy, pipeline), own in zip(SETTINGS, shares, strict=True)
            for name, accuracy in zip(OBJECTS, own, strict=True)
        ]
    )  # fmt: skip


def drawn(seed=0):
    """Accuracies of each setting that differ in all means."""
    generator = np.random.default_rng(seed)
    middles = np.linspace(0.3, 0.7, len(SETTINGS))[generator.permutation(len(SETTINGS))]
    return np.clip(middles[:, None] + generator.normal(0, 0.15, (len(SETTINGS), 12)), 0, 1)


def compared_of(first, second):
    classes = [name.split("/")[0] for name in OBJECTS]
    return compare_paired(first, second, np.ones(12), IntervalParameters(), classes)


def test_a_gain_is_of_the_network_over_the_discriminant_in_its_own_setting():
    shares = drawn()
    gains = Gains.of(rows_of(shares))
    expected = {
        (frame, strategy): compared_of(
            shares[SETTINGS.index((frame, strategy, "learned"))],
            shares[SETTINGS.index((frame, strategy, "order_free"))],
        )
        for frame, strategy in product(FRAMES, STRATEGIES)
    }
    assert {(one.frame, one.strategy) for one in gains.compared} == {*expected}
    for setting, found in gains.compared.items():
        one = expected[setting.frame, setting.strategy]
        assert found.difference.mean == pytest.approx(one.difference.mean)
        assert found.p_value == pytest.approx(one.p_value)
    for kind, stands in (
        ("p_value", gains.stands),
        ("p_value_new_classes", gains.stands_for_new_classes),
    ):
        p_values = [getattr(one, kind) for one in gains.compared.values()]
        corrected = [value < 0.05 for value in holm(p_values)]
        assert [*stands.values()] == corrected
        # The correction drops some, so that it can be missed.
        assert 0 < sum(corrected) < sum(value < 0.05 for value in p_values)
    means = {key: one.difference.mean for key, one in gains.compared.items()}
    ahead = sum(gains.stands[key] and mean > 0 for key, mean in means.items())
    assert gains.ahead(5) == (ahead, 12)
    assert ahead < sum(gains.stands.values())
    wide = gains.stands_for_new_classes
    assert gains.ahead_for_new_classes(5) == (
        sum(wide[key] and mean > 0 for key, mean in means.items()),
        12,
    )
    assert gains.range() == pytest.approx((min(means.values()), max(means.values())))
    assert (gains.objects, gains.classes) == (12, 3)


def test_questions_are_of_few_touches_of_many_and_of_all_views():
    parts = [rows_of(drawn()), rows_of(drawn(1), touches=LONG), rows_of(drawn(2), views=16)]
    single, long, together = answers_of(pd.concat([*parts, rows_of(drawn(3), touches=1)]))
    assert {(one.touches, one.views) for one in single.compared} == {(5, 1), (1, 1)}
    assert {(one.touches, one.views) for one in long.compared} == {(LONG, 1)}
    assert {(one.touches, one.views) for one in together.compared} == {(5, 16)}
    assert single.ahead(1)[1] == single.ahead(5)[1] == 12


def test_a_lead_is_of_the_first_places_over_the_second_in_its_own_frame_and_pipeline():
    shares = drawn()
    places = {
        "seeing": ("fixation", "random"),
        "sight": ("random_visible", "random"),
        "salience": ("fixation", "random_visible"),
    }
    leads = leads_of(pd.concat([rows_of(shares), rows_of(drawn(1), touches=1)]))
    assert len(leads) == len(FRAMES) * len(PIPELINES) * len(places)
    for one in leads:
        first, second = (
            shares[SETTINGS.index((one.known, place, one.pipeline))] for place in places[one.name]
        )
        expected = compared_of(first, second)
        assert one.difference.mean == pytest.approx(expected.difference.mean)
        assert one.p_value == pytest.approx(expected.p_value)
        assert one.p_value_new_classes == pytest.approx(expected.p_value_new_classes)
        assert (one.turns, one.draws, one.objects) == ("none", 1, 12)


def test_objects_of_the_benchmark_are_no_others(tmp_path, monkeypatch):
    rows = rows_of(drawn())
    rows.to_parquet(tmp_path / "kept_all.parquet")
    rows[rows["object"].isin(OBJECTS[:8])].to_parquet(tmp_path / "kept_benchmark.parquet")
    monkeypatch.setattr(compared, "FOLDER", tmp_path)
    whole, others = kept_of_all()
    assert {*whole["object"]} == {*OBJECTS}
    assert {*others["object"]} == {*OBJECTS[8:]}


def test_rows_of_the_whole_study_are_no_rows_of_set_all(tmp_path, monkeypatch):
    both = pd.concat([rows_of(drawn()), rows_of(drawn(1), views=16)])
    both.to_parquet(tmp_path / "kept_all.parquet")
    monkeypatch.setattr(compared, "FOLDER", tmp_path)
    with pytest.raises(
        ValueError, match="not only one view with 5 touches; run `make learned_all`"
    ):
        kept_of_all()


def test_accuracies_without_an_object_in_common_are_refused():
    rows = rows_of(drawn())
    setting = ComparedSetting("none", "full", 5, 1, "fixation")
    first, second = (
        compared.accuracies_in(rows[rows["object"].isin(own)], setting, "learned")
        for own in (OBJECTS[:3], OBJECTS[3:])
    )
    with pytest.raises(LookupError, match="no object in common"):
        compared.compare(first, second)
