"""Other people's tools use the workflow: another workflow as a module, and Snakemake's own report."""

import pytest
from workflow.experiments import Experiment

pytestmark = [pytest.mark.workflow, pytest.mark.long]

OUTER = """
import yaml
from pathlib import Path

module visuohaptic:
    snakefile:
        "{folder}/workflow/Snakefile"
    config:
        yaml.safe_load(Path("{folder}/params.yaml").read_text())


use rule * from visuohaptic as visuohaptic_*


rule mine:
    default_target: True
    input:
        "{table}",
    output:
        "mine.parquet",
    shell:
        "cp {{input}} {{output}}"
"""
TABLE = "results/features/several_objects/1/00-01.parquet"


def test_another_workflow_uses_this_one_as_a_module(whole_stand_in, tmp_path):
    outer = Experiment(tmp_path)
    text = OUTER.format(folder=whole_stand_in.folder, table=TABLE)
    (tmp_path / "Snakefile").write_text(text)
    output = outer.snakemake().stdout
    assert "rule visuohaptic_meshes" in output or "preparing several_objects/1" in output
    assert (tmp_path / "mine.parquet").read_text().startswith(TABLE)
    assert "Nothing to be done" in outer.snakemake("-n").stdout


def test_snakemakes_own_report_shows_tables_with_captions(experiment):
    experiment.snakemake("--report", "snakemake-report.html")
    page = (experiment.folder / "snakemake-report.html").read_text()
    for name in ("accuracy.csv", "confusion.csv", "report.html", "metrics.json"):
        assert name in page
    assert "correctly classified test sequences" in page
