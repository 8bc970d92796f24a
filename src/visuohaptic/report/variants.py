"""What the report says of the paper in all its variants.

Folder ``studies/variants`` of the repository holds that study: its tables and rules give the verdict and the
sentences, which a run of it writes and `variants.json` beside this file keeps.
"""

from __future__ import annotations

from importlib.resources import files
from pathlib import Path
from typing import Literal

from pydantic import BaseModel, ConfigDict

from visuohaptic.report.estimates import read_json
from visuohaptic.studies.stored import Source

Verdict = Literal["yes", "no", "depends", "not shown"]

KEPT = "variants.json"

VARIANTS = "reports/variants.json"
"""What a run of the study writes."""


class Spread(BaseModel):
    """Variants on one set of objects, and in how many fixation leads or trails significantly."""

    model_config = ConfigDict(frozen=True)

    objects: int
    variants: int
    ahead: int
    behind: int


class Lead(BaseModel):
    """The lead of fixations over random touches in reach under one variant, as a share, with its interval over objects."""

    model_config = ConfigDict(frozen=True)

    objects: int
    variant: Literal["default", "literal"]
    difference: float
    low: float
    high: float


class VariantsSummary(BaseModel):
    """What all variants say together: whether fixation leads, by the rule in studies/variants/README.md, and of how many.

    `leads` are those of the default and of the most literal variant. `literal` are accuracies of the most literal
    variant, by strategy and classifier. `source` is None for this run.
    """

    model_config = ConfigDict(frozen=True)

    verdict: Verdict
    spread: tuple[Spread, ...] = ()
    leads: tuple[Lead, ...] = ()
    sentences: tuple[str, ...] = ()
    literal: dict[str, dict[str, float]] = {}
    source: Source | None = None


def read_variants(path: Path | None = None) -> VariantsSummary:
    """Read what a run of the study wrote, ``reports/variants.json``, else what is kept with the package."""
    if path is None:
        kept = files("visuohaptic.report").joinpath(KEPT).read_text("utf-8")
        return VariantsSummary.model_validate_json(kept)
    return read_json(
        path,
        lambda found: VariantsSummary.model_validate(found["report"]),
        "has no summary of the variants",
        "run `snakemake -j2 variants_all` again",
    )
