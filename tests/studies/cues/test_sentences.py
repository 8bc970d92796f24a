"""The sentences on what carries the accuracy: each number and each verdict, counted again from the tables by pandas."""

import re
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest
from report.pages import plain

from cues.kept import CueSetting, MeasuredCues, kept_cues, kept_cues_of, read_cues
from cues.section import kept_sentences, own_sentences
from cues.sentences import carries_sentence, imprints_sentence
from cues.study import STUDY
from cues.tables import ACCURACIES
from visuohaptic.base.errors import ReportError
from visuohaptic.evaluation.intervals import compare_paired, object_interval
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.recognition.parameters import IntervalParameters
from visuohaptic.tables.schema import build_table, write_table

INTERVALS = IntervalParameters()
KEPT = {
    file.stem.removeprefix("kept_"): pd.read_parquet(file)
    for file in (Path(__file__).parents[3] / "studies/cues").glob("kept_*.parquet")
}
UPRIGHT = {"tested": "new", "turns": "none", "frame": "full", "touches": 5, "strategy": "fixation"}
NUMBER = r"([+−]?\d+\.\d)"
SHARE = rf"{NUMBER} % \({NUMBER} % to {NUMBER} %\)"
POINTS = rf"{NUMBER} points \({NUMBER} to {NUMBER}\)"
PIPELINES = {"pipeline order_free": "order_free", "the paper's pipeline": "paper"}
CARRIES = {
    "Where the sensor is and how it stands carries more than what the skin feels": 1,
    "What the skin feels carries more than where the sensor is and how it stands": -1,
    "Which of the two carries more is not settled": 0,
}
ADDED = {
    "Imprints add to positions and normals": 1,
    "Imprints take from what positions and normals give": -1,
    "That imprints add anything to positions and normals is not shown": 0,
}


def cell(table, name, **named):
    """Return accuracy and weight by object of one cell."""
    chosen = table.query(" and ".join(f"{key} == {value!r}" for key, value in named.items()))
    chosen = chosen[chosen["cues"] == name].set_index(["class", "object"])
    assert chosen.index.is_unique
    return chosen[["accuracy", "weight"]]


def accuracy(table, name, **named):
    rows = cell(table, name, **named)
    mean = np.average(rows["accuracy"], weights=rows["weight"])
    found = object_interval(rows["accuracy"].to_numpy(), rows["weight"].to_numpy(), INTERVALS)
    return mean, found.low, found.high


def difference(table, first, second, **named):
    both = cell(table, first, **named).merge(
        cell(table, second, **named), left_index=True, right_index=True, suffixes=("", "_2")
    )
    values = both["accuracy"] - both["accuracy_2"]
    arrays = (both[name].to_numpy() for name in ("accuracy", "accuracy_2", "weight"))
    found = compare_paired(*arrays, INTERVALS).difference
    return np.average(values, weights=both["weight"]), found.low, found.high


def shown(triple, signed=False):
    form = "+.1f" if signed else ".1f"
    return tuple(f"{100 * value:{form}}".replace("-", "−") for value in triple)


def sign(triple):
    return 1 if triple[1] > 0 else -1 if triple[2] < 0 else 0


def check_carries(text, table):
    """Compare all numbers and verdicts of `carries_sentence` with a table."""
    first, *verdicts = re.split(r"(?<=\.) (?=[A-Z])", text)
    found = re.findall(SHARE, first)
    assert found == [
        shown(accuracy(table, name, **UPRIGHT, pipeline=pipeline))
        for name in ("pose", "imprint")
        for pipeline in PIPELINES.values()
    ]
    assert re.search(
        rf"{SHARE} by pipeline order_free and {SHARE} by the paper's pipeline; imprints only", first
    )
    said = set()
    for verdict in verdicts:
        words, _, numbers = verdict.partition(": ")
        pair = ("pose", "imprint") if words in CARRIES else ("all", "pose")
        in_pipelines = re.findall(
            rf"{POINTS} in (pipeline order_free|the paper's pipeline)", numbers
        )
        assert in_pipelines
        for *triple, pipeline in in_pipelines:
            own = difference(table, *pair, **UPRIGHT, pipeline=PIPELINES[pipeline])
            assert tuple(triple) == shown(own, signed=True)
            assert sign(own) == {**CARRIES, **ADDED}[words]
            said.add((pair, pipeline))
    assert len(said) == 4


@pytest.mark.parametrize("name", KEPT)
def test_each_number_and_each_verdict_is_that_of_the_kept_table(name):
    text = plain(carries_sentence(kept_cues_of(name), INTERVALS))
    check_carries(text, KEPT[name])
    objects = KEPT[name].groupby(["class", "object"]).ngroups
    assert f"({objects} objects of set {name}, measured on 2" in text


WORDS = {
    "pose known, five touches": ("new", "none", "full", 5),
    "pose known, one touch": ("new", "none", "full", 1),
    "nothing known of the pose, five touches": ("new", "none", "none", 5),
    "nothing known of the pose, one touch": ("new", "none", "none", 1),
    "objects turned in any way and nothing known of the pose, five touches": ("new", "any", "none", 5),
    "known objects from new viewpoints, one touch": ("known", "none", "full", 1),
    "known objects from new viewpoints, nothing known of the pose, five touches": (
        "known", "none", "none", 5,
    ),
}  # fmt: skip


def check_imprints(text, table):
    parts = text.removeprefix("What imprints add to positions and normals in pipeline order_free: ")
    parts = re.sub(r" \(\d+ objects? of .*\)\.$", "", parts).split("; ")
    for part in parts:
        words, _, said = part.partition(": ")
        keys = dict(zip(("tested", "turns", "frame", "touches"), WORDS[words], strict=True))
        keys |= {"strategy": "fixation", "pipeline": "order_free"}
        if cell(table, "pose", **keys).empty:
            assert said.endswith(", all of it by the imprint")
            assert re.findall(SHARE, said) == [shown(accuracy(table, "all", **keys))]
            continue
        gain = difference(table, "all", "pose", **keys)
        assert re.findall(POINTS, said) == [shown(gain, signed=True)]
        ending = {1: "", -1: ", a loss", 0: ", not settled"}[sign(gain)]
        assert re.sub(POINTS, "", said) == ending
    measured = {
        words
        for words, key in WORDS.items()
        if not table.query(
            f"tested == {key[0]!r} and turns == {key[1]!r} and frame == {key[2]!r} and touches == {key[3]}"
        ).empty
    }
    assert {part.partition(": ")[0] for part in parts} == measured


@pytest.mark.parametrize("name", KEPT)
def test_each_gain_by_imprints_is_that_of_the_kept_table(name):
    check_imprints(plain(imprints_sentence(kept_cues_of(name), INTERVALS)), KEPT[name])


def test_both_sets_are_kept():
    assert set(KEPT) == {"paper", "benchmark"}
    assert list(kept_cues()) == ["paper", "benchmark"]
    assert [one.objects for one in kept_cues().values()] == [12, 142]


def made_up(path, lifts, objects=40):
    """Write a table in which each cue has its own accuracy by pipeline; `lifts` maps pipeline and cue to a mean."""
    generator = np.random.default_rng(0)
    rows = []
    for (pipeline, name), mean in lifts.items():
        values = np.clip(mean + 0.05 * generator.normal(size=objects), 0, 1)
        rows += [
            {
                **UPRIGHT, "pipeline": pipeline, "cues": name, "classifier": "one", "class": "box",
                "object": f"o{number:02d}", "accuracy": value, "weight": 1.0 + number % 3,
            }
            for number, value in enumerate(values)
        ]  # fmt: skip
    columns = pd.DataFrame(rows).to_dict("list")
    write_table(ACCURACIES, build_table(ACCURACIES, columns), path)
    return pd.read_parquet(path)


def lifts(**of_pipelines):
    return {
        (pipeline, name): mean
        for pipeline, means in of_pipelines.items()
        for name, mean in zip(("position", "normal", "pose", "imprint", "all"), means, strict=True)
    }


@pytest.mark.parametrize(
    ("means", "words"),
    [
        (
            {"order_free": (0.5, 0.5, 0.8, 0.4, 0.95), "paper": (0.5, 0.5, 0.7, 0.3, 0.7)},
            ["carries more than what the skin feels: +", "Imprints add to", "is not shown: "],
        ),
        (
            {"order_free": (0.5, 0.5, 0.3, 0.8, 0.1), "paper": (0.5, 0.5, 0.5, 0.5, 0.5)},
            ["What the skin feels carries more", "is not settled: ", "Imprints take from"],
        ),
    ],
)
def test_a_verdict_follows_from_the_interval_in_each_pipeline(tmp_path, means, words):
    own = tmp_path / "cues.parquet"
    table = made_up(own, lifts(**means))
    text = plain(carries_sentence(read_cues(own), INTERVALS))
    check_carries(text, table)
    assert all(word in text for word in words)
    assert "(40 objects of this run)" in text
    assert "set paper" not in text


def test_the_verdict_has_the_sign_of_an_interval_and_not_of_a_mean(tmp_path):
    own = tmp_path / "cues.parquet"
    means = {"order_free": (0.5, 0.5, 0.8, 0.7, 0.81), "paper": (0.5, 0.5, 0.8, 0.7, 0.81)}
    made_up(own, lifts(**means), objects=2)
    text = plain(carries_sentence(read_cues(own), INTERVALS))
    assert "Which of the two carries more is not settled: +" in text


def test_figures_of_another_set_are_named_as_such():
    text = plain(carries_sentence(kept_cues_of("mine"), INTERVALS))
    largest = max(KEPT, key=lambda name: KEPT[name].groupby(["class", "object"]).ngroups)
    assert f"objects of set {largest}, measured on" in text
    assert "this run" not in text


def test_cues_of_the_run_take_the_place_of_those_that_are_kept(tmp_path):
    def context(path):
        run = SimpleNamespace(
            existing_file={STUDY.kept: path}.get, parameters=ExperimentParameters()
        )
        return SimpleNamespace(run=run)

    assert list(own_sentences(context(None))) == []
    assert all("12 objects of set paper" in one for one in kept_sentences(context(None)))
    made_up(tmp_path / "cues.parquet", lifts(paper=(0.5, 0.5, 0.5, 0.5, 0.5)), objects=3)
    own = list(own_sentences(context(tmp_path / "cues.parquet")))
    assert all("(3 objects of this run)" in one for one in own)
    assert len(own) == 2
    assert list(kept_sentences(context(tmp_path / "cues.parquet"))) == []


@pytest.mark.parametrize(("touches", "strategy"), [(7, "fixation"), (5, "human")])
def test_what_was_not_measured_is_said_without_a_number(touches, strategy):
    text = plain(carries_sentence(kept_cues_of("paper"), INTERVALS, touches, strategy))
    assert text.startswith(
        f"What carries the accuracy was not measured for {touches} touches by strategy {strategy} ("
    )
    assert "%" not in text


def test_a_pair_is_over_the_objects_of_both_and_a_missing_cell_is_named(tmp_path):
    path = tmp_path / "cues.parquet"
    made_up(path, lifts(paper=(0.5, 0.5, 0.5, 0.5, 0.5)), objects=3)
    measured = read_cues(path)
    setting = CueSetting("new", "none", "full", 5, "paper", "fixation")
    frame = measured.table.to_pandas()
    kept = ~((frame["cues"] == "all") & (frame["object"] == "o01"))
    shorter = MeasuredCues(measured.table.filter(kept.to_numpy()))
    triple = shorter.difference(setting, "all", "pose", INTERVALS)
    expected = difference(frame[kept], "all", "pose", **UPRIGHT, pipeline="paper")
    assert (triple.mean, triple.low, triple.high) == pytest.approx(expected)
    with pytest.raises(ReportError, match="by imprints only is measured for new none full 1 paper"):
        shorter.accuracy(setting._replace(touches=1), "imprint", INTERVALS)


def test_a_damaged_file_is_named(tmp_path):
    path = tmp_path / "cues.parquet"
    path.write_text("no table")
    with pytest.raises(
        ReportError, match=r"cues\.parquet holds no result of study cues .*make cues"
    ):
        read_cues(path)
