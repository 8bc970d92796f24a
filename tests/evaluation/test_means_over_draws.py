"""Figures of random probing are means over draws of its places, and say how far one draw moves them."""

import pandas as pd
import pyarrow as pa
import pytest
from recognition.synthetic import features_table

from visuohaptic import recognition
from visuohaptic.base.draw_names import draw_of, name_of_draw
from visuohaptic.evaluation.means_over_draws import further_draws
from visuohaptic.evaluation.summary import summarise
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.recognition.parameters import ProtocolParameters, RecognitionParameters
from visuohaptic.studies.conditions import Planned
from visuohaptic.studies.measuring import error_rows, measure_conditions
from visuohaptic.studies.study import Condition
from visuohaptic.tables.schema import build_rows
from visuohaptic.tables.studies import STUDY

SVM = "support_vector_machine"
RECOGNITION = RecognitionParameters(
    classifiers=(SVM,),
    pipelines=("paper",),
    protocol=ProtocolParameters(protocol="grouped_folds", folds=3, repeats=2),
)
OBJECTS = (3, 4, 3)
FURTHER = ("random#1", "random#2")


@pytest.fixture(scope="module")
def tables():
    """Scores and predictions by fixation and draw 0, and rows of two further draws, with a sequence left out."""
    runs, parts = [], []
    for seed, name in enumerate(("fixation", "random", *FURTHER)):
        features = features_table(name, OBJECTS, separation=1, seed=seed)
        if name == "random#2":
            features = features.slice(1)
        if name in FURTHER:
            probing = {"strategies": (name,)}
            run = ExperimentParameters.from_mapping({"probing": probing})
            run = run.model_copy(update={"recognition": RECOGNITION})
            parts += measure_conditions(
                "random_draws", [Planned(Condition("further draws"), run, None)], features, 1
            )
        else:
            runs.append(recognition.run_pipeline(features, RECOGNITION, 1))
    return *(pa.concat_tables(one) for one in zip(*runs, strict=True)), pa.concat_tables(parts)


def by_object(rows):
    """Accuracies and weights by object (rows) and strategy (columns), from predictions or rows of a study."""
    rows = rows.assign(
        split=rows["split"].astype(str)
        + "/"
        + rows.filter(regex="^(seed|repeat)$").iloc[:, 0].astype(str)
    )
    totals = rows.groupby(["strategy", "split"])["sequences"].transform("sum")
    rows = rows.assign(
        right=rows["accuracy"] * rows["sequences"] / totals, weight=rows["sequences"] / totals
    )
    sums = rows.groupby(["class", "object", "strategy"])[["right", "weight"]].sum().unstack()
    return sums["right"] / sums["weight"], sums["weight"]


def test_means_leads_and_spread_are_those_that_pandas_counts(tables):
    _, predictions, drawn = tables
    found = summarise(*tables[:2], None, drawn)
    rows = predictions.to_pandas().assign(sequences=1)
    rows["accuracy"] = (rows["predicted"] == rows["class"]).astype(float)
    parts = [by_object(rows), by_object(drawn.to_pandas())]
    accuracy, weight = (pd.concat(one, axis=1) for one in zip(*parts, strict=True))
    draws = accuracy[["random", *FURTHER]]
    shares = (draws * weight).sum() / weight.sum()
    leads = draws.rsub(accuracy["fixation"], axis=0).mul(weight["fixation"], axis=0).sum()
    leads /= weight["fixation"].sum()
    compared = found["comparisons"]["paper"][SVM]["random"]
    assert len(set(leads)) == 3
    assert compared["draws"]["count"] == 3
    assert compared["draws"]["leads"] == pytest.approx(leads[draws.columns].tolist())
    assert compared["draws"]["standard_deviation"] == pytest.approx(leads.std(ddof=1))
    assert compared["difference"]["mean"] == pytest.approx(leads.mean())
    cell = found["results"]["paper"]["random"][SVM]
    assert cell["draws"]["accuracies"] == pytest.approx(shares[draws.columns].tolist())
    mean, mean_weight = draws.mean(axis=1), weight[draws.columns].mean(axis=1)
    assert cell["accuracy"]["mean"] == pytest.approx((mean * mean_weight).sum() / mean_weight.sum())
    known = {"/".join(key): value for key, value in mean.items()}
    assert {key: value for key, (value, _) in cell["by_object"].items()} == pytest.approx(known)


def test_the_interval_and_the_p_value_are_of_each_objects_mean_over_draws(tables):
    compared = summarise(*tables[:2], None, tables[2])["comparisons"]["paper"][SVM]["random"]
    first = summarise(*tables[:2])["comparisons"]["paper"][SVM]["random"]
    ends = [compared["difference"][name] for name in ("low", "high")]
    assert ends != [first["difference"][name] for name in ("low", "high")]
    assert ends[0] < compared["difference"]["mean"] < ends[1]
    assert compared["p_value"] != first["p_value"]


def test_without_further_draws_and_for_other_cells_nothing_changes(tables):
    alone = summarise(*tables[:2])
    found = summarise(*tables[:2], None, STUDY.arrow.empty_table())
    assert found == alone
    assert "draws" not in alone["results"]["paper"]["random"][SVM]
    with_draws = summarise(*tables[:2], None, tables[2])
    assert with_draws["results"]["paper"]["fixation"] == alone["results"]["paper"]["fixation"]


def test_a_draw_that_could_not_be_measured_is_named(tables):
    key = ("random_draws", "further draws", "paper", "random#3")
    failed = error_rows(key, (SVM,), "No viewpoint has 5 touches.")
    found = summarise(*tables[:2], None, pa.concat_tables([tables[2], failed]))
    cell = found["results"]["paper"]["random"][SVM]
    assert cell["draws"]["count"] == 3
    assert cell["notes"] == [
        "draw 3 of the places could not be measured: No viewpoint has 5 touches"
    ]


def test_draws_are_in_the_order_of_their_numbers():
    key = {"study": "s", "condition": "c", "pipeline": "paper", "classifier": SVM, "class": "cup"}
    key |= {"object": "a", "split": 0, "repeat": 0, "sequences": 10, "seconds": 1.0, "error": None}
    rows = [key | {"strategy": f"random#{draw}", "accuracy": draw / 10} for draw in (10, 2, 1)]
    (found,) = further_draws(build_rows(STUDY, rows)).values()
    assert [one.mean for one in found.draws] == [0.1, 0.2, 1.0]


def test_a_draws_name_says_its_strategy_and_number():
    assert [name_of_draw("random", draw) for draw in (0, 1, 12)] == [
        "random",
        "random#1",
        "random#12",
    ]
    assert [draw_of(name) for name in ("random", "random#12")] == [("random", 0), ("random", 12)]
