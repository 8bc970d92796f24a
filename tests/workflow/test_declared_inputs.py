"""What a job reads is declared: an edit reruns what depends on it, and nothing else."""

import csv

import pytest
from small_experiment import SMALL_OBJECTS as OBJECTS

from visuohaptic.pipeline import OF_OBJECT

pytestmark = pytest.mark.workflow

ALL_BUT_MESHES = {
    "fixations", "touches", "features", "recognition", "metrics", "report", "block_of_study",
    "cost_seconds", "cost", "effect_influence", "stability_of_object",
    "guards", "guards_hold",
}  # fmt: skip
OF_THE_SHAPE = ("width_cm", "depth_cm", "height_cm", "rotation")
KEYS = ("class", "object", "set")


def edit(path, name, column, value):
    with path.open(newline="") as stream:
        rows = list(csv.DictReader(stream))
    for row in rows:
        if row["object"] == name:
            row[column] = value
    with path.open("w", newline="") as stream:
        writer = csv.DictWriter(stream, rows[0].keys(), lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


@pytest.mark.long
def test_each_column_of_an_objects_shape_reruns_its_mesh_and_what_follows(experiment):
    catalogue = experiment.folder / "meshes/catalogue.csv"
    for column, name in zip(OF_THE_SHAPE, OBJECTS, strict=True):
        edit(catalogue, name, column, "0 0 1 0 1 0 -1 0 0" if column == "rotation" else "77.7")
    planned = experiment.planned()
    assert planned["meshes"] == len(OF_THE_SHAPE)
    assert set(planned) - {"meshes"} == ALL_BUT_MESHES


def test_all_other_columns_rerun_the_report_alone(experiment):
    catalogue = experiment.folder / "meshes/catalogue.csv"
    with catalogue.open(newline="") as stream:
        columns = next(csv.reader(stream))
    for column in columns:
        if column not in {*KEYS, *OF_THE_SHAPE}:
            edit(catalogue, "bsby_chair3", column, "1234")
    assert experiment.planned() == {"report": 1}


def test_a_corrected_credit_reruns_the_report_alone(experiment):
    edit(experiment.folder / "meshes/paper/credits.csv", "bsby_chair3", "licence", "CC0-1.0")
    assert experiment.planned() == {"report": 1}


def test_every_parameter_of_a_rule_is_of_a_type_that_snakemake_remembers(fresh, tmp_path):
    experiment = fresh.copy(tmp_path / "experiment")
    experiment.set(meshes={"set": "hard"})
    (experiment.folder / "meshes/catalogue.csv").write_text(
        (fresh.folder / "meshes/catalogue.csv").read_text().replace(",paper,", ",hard,", 1)
    )
    (experiment.folder / "Checked").write_text(
        """
include: "Snakefile"

def check(value, path):
    assert type(value) in {str, int, float, bool, type(None), list, tuple, dict}, (path, type(value))
    if isinstance(value, dict):
        for name, inner in value.items():
            check(inner, [*path, name])
    elif isinstance(value, list | tuple):
        for inner in value:
            check(inner, path)

CHECKED = planned_jobs()
for job in CHECKED:
    check(job.find_params(), [job.rule])
print("checked", len({job.rule for job in CHECKED}), "rules")
"""
    )
    output = experiment.snakemake("-n", "-s", "Checked", "--", "meshes_all").stdout
    with_a_script = sum(
        len(OF_OBJECT) if file.stem == "phases" else file.read_text().count("    script:")
        for file in (fresh.folder / "workflow/rules").glob("*.smk")
    )
    assert f"checked {with_a_script} rules" in output


def test_what_no_job_makes_is_read_from_the_clone_also_where_results_are_in_a_storage(
    fresh, tmp_path
):
    experiment = fresh.copy(tmp_path / "experiment")
    (experiment.folder / "Checked").write_text(
        """
include: "Snakefile"

from types import SimpleNamespace
from snakemake.io import is_flagged

MADE = {file for job in planned_jobs() for file in job.outputs}
CHECKED = 0
for job in planned_jobs():
    for found in DECLARED[job.rule].files(SimpleNamespace(**job.wildcards)).values():
        for file in [found] if isinstance(found, str) else found:
            if str(file) not in MADE:
                assert is_flagged(file, "local"), (job.rule, file)
                CHECKED += 1
print("checked", CHECKED > 5)
"""
    )
    output = experiment.snakemake("-n", "-s", "Checked", "--", "meshes_all").stdout
    assert "checked True" in output
