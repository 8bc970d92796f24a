"""Whatever happens to a folder, the next run makes what today's parameters, code and sources give, and nothing else."""

import os
import shutil

import numpy as np
import pytest
from workflow.conftest import Experiment
from workflow.walks import digests, make_experiment

pytestmark = pytest.mark.workflow

MODULE = "src/visuohaptic/features/describing.py"
SOURCE = "meshes/paper/chair/bsby_chair3.ply.gz"
TABLE = "results/features/chair/bsby_chair3/00-01.parquet"
LONG_AGO = (946_000_000, 946_000_000)


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """A finished experiment; its scripts are stand-ins."""
    folder = tmp_path_factory.mktemp("whole") / "experiment"
    make_experiment(folder)
    experiment = Experiment(folder)
    experiment.snakemake()
    return experiment


@pytest.fixture
def experiment(whole, tmp_path):
    return whole.copy(tmp_path / "experiment")


def ask(experiment, question):
    folder = experiment.folder
    environment = f"PYTHONPATH={folder / 'src'}:{folder / 'workflow/lib'}"
    command = ("python", "-P", "-m", "visuohaptic_workflow.why", question)
    return experiment.run("env", environment, *command, check=False)


def test_nothing_is_left_to_do_whatever_the_times_are_and_without_snakemakes_memory(experiment):
    shutil.rmtree(experiment.folder / ".snakemake")
    files = sorted(file for file in experiment.folder.rglob("*") if file.is_file())
    for file, number in zip(files, np.random.default_rng(1).permutation(len(files)), strict=True):
        os.utime(file, (1e9 + number, 1e9 + number))
    assert experiment.planned() == {}
    assert ask(experiment, "why").stdout.strip() == "Nothing to be done."
    assert ask(experiment, "verify").returncode == 0


@pytest.mark.long
def test_a_parameter_that_changes_three_times_is_seen_each_time(experiment, whole):
    for size in (0.2, 0.25, 0.3):
        experiment.set(sensor={"largest_size": size})
        assert "parameters: sensor.largest_size: " in ask(experiment, "why").stdout
        assert experiment.planned()["touches"] == 4
        assert experiment.planned()["touches"] == 4
        experiment.snakemake()
        assert experiment.planned() == {}
    assert digests(experiment.folder) == digests(whole.folder)


def test_a_source_replaced_by_an_older_file_makes_its_object_again(experiment):
    other = experiment.folder / "meshes/paper/chair/bs0_chair2.ply.gz"
    shutil.copy(other, experiment.folder / SOURCE)
    os.utime(experiment.folder / SOURCE, LONG_AGO)
    planned = experiment.planned()
    assert planned["meshes"] == planned["features"] == 1


def test_an_older_module_makes_its_phase_again(experiment):
    module = experiment.folder / MODULE
    module.write_text(f"{module.read_text()}\n# edited\n")
    os.utime(module, LONG_AGO)
    planned = experiment.planned()
    assert planned["features"] == 4
    assert not {"meshes", "fixations", "touches"} & set(planned)
    assert f"code: {MODULE}: " in ask(experiment, "why").stdout


def test_a_table_edited_by_hand_is_made_again_alone(experiment, whole):
    (experiment.folder / TABLE).write_text("edited")
    assert ask(experiment, "verify").returncode == 1
    assert experiment.planned() == {"features": 1}
    experiment.snakemake()
    assert digests(experiment.folder) == digests(whole.folder)


@pytest.mark.parametrize("target", [TABLE, "results/touches/chair/bsby_chair3/00-01.parquet"])
def test_tables_that_are_there_without_their_record_are_made_again_where_they_are_needed(
    experiment, target
):
    shutil.rmtree(experiment.folder / "results/records")
    planned = experiment.planned("--", target)
    assert planned["meshes"] == planned["fixations"] == planned["touches"] == 1


def test_after_a_run_with_other_values_verify_says_so_and_the_plain_command_makes_it_again(
    experiment, whole
):
    experiment.snakemake("--config", 'sensor={"largest_size": 0.2}', "--", "features_all")
    verified = ask(experiment, "verify")
    assert verified.returncode == 1
    assert "parameters: sensor.largest_size" in verified.stdout
    experiment.snakemake()
    assert digests(experiment.folder) == digests(whole.folder)


def test_files_of_the_user_stay_and_what_is_no_longer_named_is_put_aside(experiment):
    mine = [
        experiment.folder / "results" / name
        for name in ("features/mine.parquet", "touches/mine/a.parquet")
    ]
    for file in mine:
        file.parent.mkdir(exist_ok=True)
        file.write_text("mine")
    experiment.set(probing={"strategies": ["fixation"]})
    output = experiment.snakemake().stdout
    assert all(file.read_text() == "mine" for file in mine)
    assert not (experiment.folder / "results/scores/paper/random.parquet").exists()
    assert "files that today's run no longer names were put into .cache/aside/" in output
    assert list((experiment.folder / ".cache/aside").rglob("random.parquet"))


def test_code_edited_while_a_job_runs_certifies_nothing(experiment):
    script = experiment.folder / "workflow/scripts/phase.py"
    whole = script.read_text()
    module = experiment.folder / MODULE
    edit = f"    with open({str(module)!r}, 'a') as stream:\n        stream.write('# edited')\n"
    script.write_text(whole.replace("with job(snakemake):\n", f"with job(snakemake):\n{edit}"))
    result = experiment.snakemake("-j1", "features_all", check=False)
    assert result.returncode != 0
    assert f"{MODULE} was changed while this run was at work; run again." in result.stdout
    assert not (experiment.folder / TABLE).exists()
    script.write_text(whole)
    assert experiment.planned("features_all")["features"] == 4
