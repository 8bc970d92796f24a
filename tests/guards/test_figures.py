"""The guards of a run's figures are written after those of its training."""

from report.synthetic import write_run

from visuohaptic.guards.figures import make_guards
from visuohaptic.guards.sums import SUMS
from visuohaptic.guards.verdicts import judge, table_of
from visuohaptic.tables.guards import GUARDS
from visuohaptic.tables.schema import read_table, write_table


def test_every_guard_of_a_run_has_a_row(tmp_path):
    files = write_run(tmp_path)
    training, output = tmp_path / "training.parquet", tmp_path / "guards.parquet"
    write_table(GUARDS, table_of([judge("of training", held=False, found="A leak.")]), training)
    make_guards(training, files.predictions, files.metrics, output, seed=1)
    outcomes = {row["guard"]: row["outcome"] for row in read_table(GUARDS, output).to_pylist()}
    assert len(outcomes) == 3
    assert outcomes["of training"] == "failed"
    assert outcomes[SUMS] == "held"
