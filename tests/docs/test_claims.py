"""The sentences of docs/claims.md have the numbers of the tables and of the kept variants."""

import re
from collections import Counter
from pathlib import Path

from variants.choices import BEST_OF_PAPER
from variants.design import is_literal
from variants.kept import OUTSIDE, PAPER_SET, kept_variants
from variants.leads import against_main, sum_up
from variants.verdicts import of_papers_question
from variants.weighing import summarise_variants
from visuohaptic.report.wording import points

TEXT = (Path(__file__).parents[2] / "docs/claims.md").read_text(encoding="utf-8")
SECOND_OF_PAPER = "quadratic_discriminant"
LEAD_OF_PAPER = 0.0186
"""Published accuracy of the SVM less the published accuracy of the quadratic discriminant."""


def evidence(claim):
    """Return the cell of evidence of the claim that begins with `claim`."""
    (row,) = [line for line in TEXT.splitlines() if line.startswith(f"| {claim}")]
    return row.split(" | ")[2]


def count_orders(name):
    """Count variants by their best classifier, and variants with the paper's two best classifiers, by fixation."""
    rows = [row for row in against_main(kept_variants(name).rows) if row["part"] != "protocol"]
    by_variant = {row["variant"]: {} for row in rows if row["error"] is None}
    for row in rows:
        if row["error"] is None:
            by_variant[row["variant"]][row["classifier"]] = row["fixation"]
    counts = Counter(all=len(by_variant))
    for accuracy in by_variant.values():
        first, second = sorted(accuracy.values(), reverse=True)[:2]
        is_first = accuracy[BEST_OF_PAPER] == first
        counts["best"] += is_first
        counts["bayes"] += accuracy["naive_bayes"] == first
        counts["both"] += is_first and accuracy[SECOND_OF_PAPER] == second
        counts["close"] += abs(accuracy[BEST_OF_PAPER] - accuracy[SECOND_OF_PAPER]) <= LEAD_OF_PAPER
    return counts


def test_leads_that_the_claims_repeat_have_the_intervals_of_their_tables():
    text = TEXT.replace("+0.0", "0.0")
    first = evidence("Fixations guide touch").replace("+0.0", "0.0")
    default = re.search(r"default: (\S+) points (\(.*?\))", first)
    ours = re.search(r"in reach is (\S+) (\(.*?\)) on 12 objects and (\S+) (\(.*?\)) on 142", first)
    rows = [line for line in text.splitlines() if line.startswith("| random, in reach |")]
    assert len(rows) == 2
    assert " ".join(default.groups()) in rows[0]
    for row, repeated in zip(rows, (ours.groups()[:2], ours.groups()[2:]), strict=True):
        assert " ".join(repeated) in row


def test_variants_in_which_fixation_is_ahead_are_counted():
    counts = {}
    for name in (PAPER_SET, OUTSIDE):
        for opponent in ("reachable", "visible"):
            run = of_papers_question(kept_variants(name).rows, BEST_OF_PAPER, opponent)
            lead = sum_up(run)
            ahead, behind = lead.ahead_significantly, lead.behind_significantly
            counts[name, opponent] = f"{ahead} of {len(run)}", f"behind in {behind}"
    text = evidence("Fixations guide touch")
    in_reach, in_sight = text.partition(" Over random places among what the eye sees ")[::2]
    (ahead, behind), (ahead_outside, behind_outside) = (
        counts[name, "reachable"] for name in (PAPER_SET, OUTSIDE)
    )
    assert f"significantly ahead in {ahead} variants and {behind} on the paper's set" in in_reach
    assert f"ahead in {ahead_outside} and {behind_outside} on the 130 objects" in in_reach
    assert "fixation is ahead in {} and {} on the".format(*counts[OUTSIDE, "visible"]) in in_sight


def test_the_most_literal_variant_has_the_leads_of_the_kept_variants():
    leads = []
    for name in (PAPER_SET, OUTSIDE):
        rows = of_papers_question(kept_variants(name).rows, BEST_OF_PAPER)
        (row,) = [row for row in rows if is_literal({**row, "random_probing": "walk"})]
        ends = (points(row[f"ahead_{end}"]) for end in ("low", "high"))
        leads.append("{} ({} to {})".format(points(row["ahead"]), *ends))
    text = evidence("Fixations guide touch")
    assert "most literal variant: {} and {}.".format(*leads) in text


def test_variants_that_reach_the_published_accuracy_are_counted():
    paper = summarise_variants(kept_variants(PAPER_SET).rows)
    outside = summarise_variants(kept_variants(OUTSIDE).rows)
    of_svm, known = (paper[part][BEST_OF_PAPER] for part in ("classifiers", "known_objects"))
    spread = [f"{100 * of_svm[name]:.1f}" for name in ("lowest", "highest", "median", "default")]
    expected = (
        "As a mean over splits: {} to {} %, median {} %, over {} variants; none reaches 93.45 % "
        "(default {} %, "
    )
    text = evidence("New objects of known classes")
    lowest, highest, median, default = spread
    assert expected.format(lowest, highest, median, of_svm["variants"], default) in text
    assert of_svm["variants_reaching"] == 0
    with_a_split = of_svm["variants_with_a_split_reaching"]
    assert f"At least one split reaches 93.45 % in {with_a_split} variants" in text
    assert outside["classifiers"][BEST_OF_PAPER]["variants_reaching"] == 0
    for of_set in (outside["classifiers"], paper["known_objects"]):
        assert f"(at most {100 * of_set[BEST_OF_PAPER]['highest']:.1f} %)" in text
    assert known["variants_reaching"] == 0


def test_variants_are_counted_by_their_best_classifiers():
    paper, outside = count_orders(PAPER_SET), count_orders(OUTSIDE)
    assert evidence("SVM is the best") == (
        "SVM is the best in {best} of {all} variants, naïve Bayes in {bayes}; ".format(**paper)
        + "on 130 objects SVM in {best} of {all}. ".format(**outside)
        + "SVM comes first and the discriminant second in {both} ".format(**paper)
        + "({both} on 130 objects); ".format(**outside)
        + "the two are within 1.86 points in {close} ".format(**paper)
        + "({close})".format(**outside)
    )
