"""Study `variants`: how each choice that the paper leaves open changes its results."""

from __future__ import annotations

from variants.design import variant_conditions
from visuohaptic.studies.study import Step, Study

STUDY = Study(
    "variants",
    "The paper in all its variants",
    variant_conditions,
    steps=(
        Step(
            "variants",
            "variants.summary:make_variants",
            ("results/variants.parquet", "reports/variants.json"),
            needs={"include": {"meshes": {"set"}, "recognition": {"intervals"}}},
        ),
        Step(
            "variants_page",
            "variants.page:make_variants_page",
            ("reports/variants.html",),
            inputs=("results/variants.parquet",),
            is_shown=False,
        ),
        # A single variant: `snakemake -j2 results/variant/r017.json`.
        Step(
            "variant",
            "variants.one:make_variant",
            ("results/variant/{condition}.json",),
            needs={"include": {"seed": True, "recognition": {"intervals"}}},
            is_shown=False,
        ),
    ),
    has_figures=False,
    kept="results/variants.parquet",
)
