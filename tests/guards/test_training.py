"""The guards of a run become rows of a table: of training and of random places first, then of its figures."""

import pytest
from recognition.synthetic import features_table
from report.synthetic import write_run

from visuohaptic.guards.areas import UNIFORM
from visuohaptic.guards.figures import make_guards
from visuohaptic.guards.p_values import SIGNS
from visuohaptic.guards.training import make_training_guards
from visuohaptic.recognition.parameters import RecognitionParameters
from visuohaptic.tables.guards import GUARDS
from visuohaptic.tables.phases import FEATURES
from visuohaptic.tables.schema import read_table, write_table


def guarded(folder, features):
    files = write_run(folder)
    own, training, guards = (folder / name for name in ("features", "training", "guards"))
    write_table(FEATURES, features, own)
    make_training_guards(
        features=[own],
        fixations=files.fixations,
        meshes={},
        output=training,
        pipelines=["paper"],
        recognition=RecognitionParameters(),
        seed=1,
    )
    make_guards(training, files.predictions, files.metrics, guards, seed=1)
    rows = read_table(GUARDS, guards).to_pylist()
    return {row["guard"]: (row["outcome"], row["found"]) for row in rows}


@pytest.mark.slow
def test_every_guard_has_a_row(tmp_path):
    found = guarded(tmp_path, features_table(separation=2.0))
    assert len(found) == 5
    # The run has few objects, and no mesh to draw places on.
    for small in (UNIFORM, SIGNS):
        outcome, reason = found.pop(small)
        assert outcome == "not tested"
        assert "are needed" in reason
    assert {outcome for outcome, _ in found.values()} == {"held"}


def test_a_run_with_too_few_objects_says_so(tmp_path):
    found = guarded(tmp_path, features_table(objects=(2, 1)))
    outcome, reason = found["test objects and training"]
    assert outcome == "not tested"
    assert "one class" in reason
