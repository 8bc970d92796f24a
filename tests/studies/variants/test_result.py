"""The section shows the variants of a run, or those that are kept, and its sentences say what the summary holds."""

import json
from types import SimpleNamespace

import pytest
from report.pages import plain
from report.test_comparison import SVM

from variants.result import (
    SUMMARY,
    Changed,
    Spread,
    VariantsSummary,
    papers_pipeline_sentences,
    read_summary,
    variant_counts_sentence,
)
from variants.section import kept_sentences, variants_values
from visuohaptic.base.errors import ReportError

MADE = VariantsSummary(
    spread=(Spread(objects=12, variants=9, ahead=1, behind=4, ahead_holm=0, behind_holm=2),),
    sentences=("Nine variants.",),
)


def test_a_runs_own_variants_take_the_place_of_those_that_are_kept(tmp_path):
    def context(path):
        run = SimpleNamespace(existing_file={SUMMARY: path}.get)
        return SimpleNamespace(run=run)

    assert variants_values(context(None)) is None
    counted, *_, measured = kept_sentences(context(None))
    assert "variants on 12 objects" in counted
    assert measured == "Measured on 2026-11-27."
    path = tmp_path / "variants.json"
    path.write_text(json.dumps({"variants": 9, "report": MADE.model_dump(mode="json")}))
    assert variants_values(context(path)) == {"variants": MADE}
    assert list(kept_sentences(context(path))) == []


@pytest.mark.parametrize("text", ["{", "[]", '{"report": {"spread": "wide"}}'])
def test_a_file_without_a_summary_is_refused_with_the_command_that_makes_one(tmp_path, text):
    path = tmp_path / "variants.json"
    path.write_text(text)
    with pytest.raises(ReportError, match=r"has no summary of the variants .* variants_all` again"):
        read_summary(path)


def variants(**spread):
    return VariantsSummary(spread=(Spread(**spread),) if spread else ())


def test_the_variants_are_counted_by_set():
    counts = {"variants": 9, "ahead": 1, "behind": 4, "ahead_holm": 0, "behind_holm": 2}
    sentence = variant_counts_sentence(variants(objects=12, **counts))
    assert sentence.endswith(
        "Fixations are ahead of random touches with p below 0.05, each variant tested by itself, in 1 of 9 variants on 12 "
        "objects (behind in 4). After Holm's correction for the number of variants they are ahead in 0 and behind in 2 of "
        "the 9 on 12 objects."
    )
    few = variant_counts_sentence(variants(objects=5, **counts))
    assert few.endswith(
        "on 5 objects (the smallest p value of so few objects, 0.062, is too large)."
    )
    assert variant_counts_sentence(variants()) == ""


def test_the_papers_pipeline_is_called_a_variant():
    changed = Changed(choice="channels of attention", default="five named", today="eight equal")
    literal = {"fixation": {SVM: 0.478}}
    kept = VariantsSummary(literal=literal, changed=(changed,))
    assert plain(papers_pipeline_sentences(kept)).endswith(
        "not the touches. Applied to later tables, the rule chooses other channels of attention: eight equal in place of "
        "five named; the default stays. The most literal variant classifies 47.8 % of the sequences by fixation correctly "
        "(support vector machine, the paper's set)."
    )
    assert papers_pipeline_sentences(VariantsSummary()).endswith("not the touches.")
