"""Study `trust`: the coverage of prediction sets, and whether the answer `unknown` is right."""

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
            inputs=("features",),
            needs={
                "include": {"seed": True, "probing": {"strategies"}, "recognition": True},
                "exclude": {"recognition": {"pipelines"}},
            },
        ),
    ),
    has_figures=False,
)
