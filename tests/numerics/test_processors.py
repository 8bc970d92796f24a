"""Imprints are described, and objects named, the same with the kernels of other processors."""

import os
import subprocess
import sys

import numpy as np
import pytest

from visuohaptic.recognition.encoding import fit_standardiser

PROCESSORS = ("Haswell", "Prescott")
"""OpenBLAS takes the kernels of the processor that this names; all x86 processors run these two."""

RUNS = """
import hashlib
import json
import sys

import numpy as np
import threadpoolctl
from recognition.synthetic import features_table, with_column
from visuohaptic.features.imprint_shape import describe_imprint_shape
from visuohaptic.recognition.experiment import run_pipeline
from visuohaptic.recognition.parameters import RecognitionParameters
from visuohaptic.tables.phases import IMPRINT_FEATURES

generator = np.random.default_rng(3)
table = features_table(separation=0.6)
smooth = np.cumsum(np.cumsum(generator.normal(size=(table.num_rows, 32, 32)), axis=1), axis=2)
smooth -= smooth.min(axis=(1, 2), keepdims=True)
described = describe_imprint_shape(smooth / smooth.max(axis=(1, 2), keepdims=True))
for name, column in zip(IMPRINT_FEATURES, described.T, strict=True):
    table = with_column(table, name, column)
found = {"described": hashlib.sha256(described.tobytes()).hexdigest()}
# A box gives columns that are constant but for rounding, which has the size of 1e-16.
rounding = 1e-16 * generator.integers(-1, 2, table.num_rows)
table = with_column(table, "contourlet_05", np.abs(rounding))
for pipeline in ("paper", "best"):
    _, predicted = run_pipeline(table, RecognitionParameters(), 3, pipeline)
    found[pipeline] = predicted.column("predicted").to_pylist()
kernels = {one.get("architecture") for one in threadpoolctl.threadpool_info()} - {None}
print(json.dumps({"kernels": sorted(kernels), "found": found}))
"""


@pytest.mark.slow
@pytest.mark.long
def test_kernels_of_another_processor_give_the_same_descriptions_and_names():
    import json

    answers = []
    for processor in PROCESSORS:
        result = subprocess.run(
            [sys.executable, "-c", RUNS],
            env={
                **os.environ,
                "OPENBLAS_CORETYPE": processor,
                "PYTHONPATH": os.pathsep.join(filter(None, sys.path)),
            },
            check=True, capture_output=True, text=True,
        )  # fmt: skip
        answers.append(json.loads(result.stdout))
    if answers[0]["kernels"] == answers[1]["kernels"]:
        pytest.skip(f"this NumPy has one set of kernels: {answers[0]['kernels']}")
    assert answers[0]["found"] == answers[1]["found"]


def test_a_column_of_rounding_alone_becomes_zero():
    columns = np.random.default_rng(0).normal(size=(50, 3))
    columns[:, 1] *= 1e-16  # around zero, as a normal's components on a box
    columns[:, 2] = 0.3 + 1e-16 * columns[:, 2]
    scale = fit_standardiser(columns, "standardise", made_of=1.0).scale
    assert scale[0] == pytest.approx(1, abs=0.3)
    assert scale[1:].tolist() == [np.inf, np.inf]
