"""Measure a single variant."""

from __future__ import annotations

import json
import tempfile
from pathlib import Path

from variants.tables import VARIANTS
from variants.weighing import variant_figures
from visuohaptic.base.atomic_files import atomic_write_text
from visuohaptic.studies.measuring import make_study_block
from visuohaptic.studies.study import StepInputs


def make_variant(step: StepInputs) -> None:
    """Measure one variant as in the study, and write its rows of `VARIANTS`, without seconds and unrounded, as JSON."""
    run = step.run
    with tempfile.TemporaryDirectory() as folder:
        block = Path(folder, "variant.parquet")
        make_study_block(
            step.study,
            [step.condition or {}],
            step.inputs["features"],
            step.recomputed_features,
            block,
            run.seed,
        )
        table = variant_figures([block], run.recognition.intervals)
    ordered = table.sort_by([(key, "ascending") for key in VARIANTS.keys])
    rows = ordered.drop_columns("seconds").to_pylist()
    atomic_write_text(step.outputs[0], json.dumps(rows, indent=2, ensure_ascii=False) + "\n")
