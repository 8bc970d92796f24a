"""The sentence on untypical objects is that of the kept answers."""

from types import SimpleNamespace

from report.pages import plain

from trust.odd import KEPT, odd_sentence
from trust.section import odd_sentences
from visuohaptic.evaluation.summary import select
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.recognition.parameters import IntervalParameters
from visuohaptic.studies.keeping import read_source
from visuohaptic.tables.phases import owners_of
from visuohaptic.tables.schema import read_table
from visuohaptic.tables.studies import EVALUATION

TABLE = read_table(EVALUATION, KEPT)


def test_the_odd_objects_are_kept_by_two_strategies():
    assert len(set(owners_of(TABLE))) == 22
    assert TABLE["strategy"].unique().to_pylist() == ["fixation", "random"]
    assert TABLE["learnt"].unique().to_pylist() == [142]
    assert set(TABLE["views"].to_pylist()) == {1, 4, 16}
    assert read_source(KEPT).set == "odd"


def test_the_sentence_has_the_shares_of_answers_from_all_views():
    rows = select(TABLE, strategy="fixation", views=16, known=True).to_pandas()
    by_object = rows.groupby(["class", "object"])[["correct", "covered"]].mean().mean()
    said = plain(odd_sentence(IntervalParameters()))
    assert f"classifies {100 * by_object['correct']:.0f} % of 22 untypical objects" in said
    assert "correctly from 16 views (measured on 2026-11-26)" in said
    assert said.endswith(f"the sets contain the class of {100 * by_object['covered']:.0f} %.")


def test_the_sentence_gives_way_to_a_model_that_was_evaluated_in_the_run(tmp_path):
    def context(path):
        run = SimpleNamespace(
            extra_path={"evaluation": path}.get, parameters=ExperimentParameters()
        )
        return SimpleNamespace(run=run)

    assert len(list(odd_sentences(context(None)))) == 1
    assert list(odd_sentences(context(tmp_path))) == []
