"""How far the answers of a model can be trusted, and whether it says `unknown` where it should."""

from __future__ import annotations

from visuohaptic.studies.study import Step, Study

STUDY = Study(
    "trust",
    "How sure answers are",
    steps=(
        Step(
            "trust",
            "trust.classes_left_out:make_trust",
            ("results/trust.parquet", "reports/trust.json"),
            takes=("features",),
            needs={
                "include": {"seed": True, "probing": {"strategies"}, "recognition": True},
                "exclude": {"recognition": {"pipelines"}},
            },
        ),
    ),
    has_figures=False,
)
