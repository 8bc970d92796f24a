"""The result of all variants together, and sentences on it."""

from __future__ import annotations

from pathlib import Path

from pydantic import BaseModel, ConfigDict

from visuohaptic.evaluation.intervals import SIGNIFICANCE
from visuohaptic.evaluation.published import PAPER_PIPELINE
from visuohaptic.report.estimates import read_json
from visuohaptic.report.wording import classifier_name, listed, percent, probability
from visuohaptic.studies.conditions import HEADLINE_CLASSIFIERS
from visuohaptic.studies.keeping import Source

SUMMARY = "reports/variants.json"
"""The file that a run of the study writes."""


class Spread(BaseModel):
    """Numbers of variants on one set of objects: all, and those with fixation ahead or behind with p below 0.05.

    `ahead` and `behind` test each variant by itself. `ahead_holm` and `behind_holm` count after Holm's correction for
    `variants` tests.
    """

    model_config = ConfigDict(frozen=True)

    objects: int
    variants: int
    ahead: int
    behind: int
    ahead_holm: int
    behind_holm: int


class Changed(BaseModel):
    """A choice for which the rule of the default chooses another option on later tables, in words."""

    model_config = ConfigDict(frozen=True)

    choice: str
    default: str
    today: str


class VariantsSummary(BaseModel):
    """The result of all variants together.

    Attributes
    ----------
    spread : tuple of Spread
        Numbers of variants, by set of objects.
    sentences : tuple of str
        Sentences for the page.
    literal : dict
        Accuracies of the most literal variant, by strategy and classifier.
    changed : tuple of Changed
        Choices for which the rule of the default, applied to later tables, chooses another option than the default.
    source : Source or None
        Where kept figures are from; None for figures of this run.
    """

    model_config = ConfigDict(frozen=True)

    spread: tuple[Spread, ...] = ()
    sentences: tuple[str, ...] = ()
    literal: dict[str, dict[str, float]] = {}
    changed: tuple[Changed, ...] = ()
    source: Source | None = None


def read_summary(path: Path) -> VariantsSummary:
    """Read the summary that a run of the study wrote, `SUMMARY`. Raises `ReportError` if the file is damaged."""
    return read_json(
        path,
        lambda stored: VariantsSummary.model_validate(stored["report"]),
        "has no summary of the variants",
        "run `snakemake -j2 variants_all` again",
    )


def variant_counts_sentence(variants: VariantsSummary) -> str:
    """Return sentences with the number of variants in which fixations are ahead or behind with p below 0.05.

    The numbers are per set of objects, of each variant tested by itself and after Holm's correction. Empty without
    variants.
    """
    if not variants.spread:
        return ""
    singly = [
        f"in {spread.ahead} of {spread.variants} variants on {spread.objects} objects (behind in {spread.behind})"
        for spread in variants.spread
    ]
    corrected = [
        f"ahead in {spread.ahead_holm} and behind in {spread.behind_holm} of the {spread.variants} on {spread.objects} "
        f"objects{_why_none(spread)}"
        for spread in variants.spread
    ]
    return (
        "The paper leaves steps open, so many variants of it were run. Fixations are ahead of random touches with p below "
        f"{SIGNIFICANCE:g}, each variant tested by itself, {listed(singly)}. After Holm's correction for the number of "
        f"variants they are {listed(corrected)}."
    )


def _why_none(spread: Spread) -> str:
    """Return a note, in brackets, if the sign changes of so few objects allow no p value that Holm's correction keeps."""
    smallest = 2.0 ** (1 - spread.objects)
    if spread.variants * smallest < SIGNIFICANCE:
        return ""
    return f" (the smallest p value of so few objects, {probability(smallest)}, is too large)"


def papers_pipeline_sentences(variants: VariantsSummary) -> str:
    """Return sentences that the paper's pipeline is one variant of the paper, and on the most literal variant."""
    said = (
        "The paper's pipeline is our variant of the paper, which a written rule chose on objects outside the paper's set. By "
        "default its map groups the 22 features, not the touches."
    )
    for one in variants.changed:
        said += (
            f" Applied to later tables, the rule chooses other {one.choice}: {one.today} in place of {one.default}; the "
            "default stays."
        )
    headline = HEADLINE_CLASSIFIERS[PAPER_PIPELINE]
    literal = variants.literal.get("fixation", {}).get(headline)
    if literal is not None:
        said += (
            f" The most literal variant classifies {percent(literal)} of the sequences by fixation correctly "
            f"({classifier_name(headline)}, the paper's set)."
        )
    return said
