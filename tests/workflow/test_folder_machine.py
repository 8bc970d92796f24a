"""Whatever happens to a working folder, the next run gives the results of a clean one, and nothing else lies beside."""

from collections import Counter

import pytest
import trimesh
from hypothesis import settings
from hypothesis.stateful import run_state_machine_as_test
from workflow.folder_machine import CONDITIONS, MESH, FolderMachine, add_branches

pytestmark = pytest.mark.workflow

EXAMPLES, STEPS = 12, 12


@pytest.fixture(scope="module")
def machine(whole_stand_in, repository, tmp_path_factory):
    """A state machine that begins with a finished run, plain or in a repository with branches and experiments."""
    work = tmp_path_factory.mktemp("machine")
    (work / "repository").mkdir()
    trimesh.creation.box().export(work / "box.stl")
    branched = repository.copy(work / "repository/experiment")
    add_branches(branched)

    class Machine(FolderMachine):
        pass

    Machine.starts = {"plain": whole_stand_in, "repository": branched}
    Machine.work, Machine.box, Machine.counts = work, work / "box.stl", Counter()
    return Machine


@pytest.fixture
def folder(machine):
    """The machine at a plain folder, to take the steps of a test."""
    taken = machine()
    taken.begin("plain")
    yield taken
    taken.teardown()


def test_after_each_run_the_folder_holds_what_a_clean_run_makes(machine, pytestconfig):
    examples = pytestconfig.getoption("examples", None) or EXAMPLES
    run_state_machine_as_test(
        machine,
        settings=settings(
            max_examples=examples,
            stateful_step_count=STEPS,
            deadline=None,
            report_multiple_bugs=False,
        ),
    )
    assert machine.counts["runs checked"] > examples


# Steps that once ended in wrong tables.


@pytest.mark.parametrize("phase", ["fixations", "touches"])
def test_a_lost_phase_is_made_again_before_its_readers_after_a_change(folder, phase):
    folder.lose_phase(phase, {"sensor": {"largest_size": 0.2}})
    folder.run("features_all")


@pytest.mark.parametrize("job", range(1, 4))
@pytest.mark.parametrize("saved", ["touches", "source"])
def test_a_run_that_failed_since_a_file_was_saved_succeeds_with_a_target(folder, saved, job):
    if saved == "source":
        folder.edit_source(back=False)
        file = folder.folder / MESH
    else:
        folder.edit_module(saved, 1, is_old=False)
        file = folder.module(saved)
    folder.run_with_fault("reports/metrics.json", "write", job, str(file), "\nVALUE = 2\n")


def test_former_blocks_without_records_are_moved_with_a_target(folder):
    folder.set_parameter({"viewpoints": {"count": 3}})
    folder.run("features_all")
    folder.set_parameter({"viewpoints": {"count": 2}})
    folder.delete_folder("results/records")
    folder.run("features_all")


def test_files_of_former_blocks_that_come_back_are_moved_if_nothing_has_to_run(folder):
    folder.set_parameter({"viewpoints": {"count": 3}})
    folder.run("features_all")
    folder.set_parameter({"viewpoints": {"count": 2}})
    folder.run("features_all")
    name = "results/touches/several_objects/0/02-02.parquet"
    (file,) = (folder.folder / ".cache/tables/records/touches").glob(f"**/{name}")
    file.rename(folder.folder / name)
    for question in ("why", "verify"):
        assert (
            f"The next run will move 1 file without a fitting record, such as {name}, to .cache/aside."
            in folder.ask(question)
        )
    folder.run("features_all")
    assert list((folder.folder / ".cache/aside").glob(f"*/{name}"))


def test_a_dry_run_moves_nothing(folder):
    folder.set_parameter({"viewpoints": {"count": 1}})
    before = folder.own_and_results()
    folder.command("snakemake", "-n", "--", "features_all")
    assert folder.own_and_results() == before


def test_a_study_leaves_the_report_with_its_values_and_comes_back_with_them(folder):
    figures = folder.folder / "reports/studies/palm.json"
    folder.write_study(CONDITIONS[0], is_listed=False)
    folder.run("study_palm")
    assert figures.exists()
    folder.set_parameter({"sensor": {"largest_size": 0.25}})
    said = folder.snakemake("all").stdout
    assert "The report leaves out study palm" in said
    assert "`snakemake -j2 study_palm` measures with today's values" in said
    folder.check("all")
    assert not figures.exists()
    folder.set_parameter({"sensor": {"largest_size": 0.3}})
    said = folder.snakemake("all").stdout
    assert "Nothing to be done" in said
    assert "leaves out" not in said
    folder.check("all")
    assert figures.exists()
    (folder.folder / "studies/palm.yaml").unlink()
    sentence = "The report leaves out study palm, whose file is deleted or can't be read."
    assert sentence in folder.ask("why")


def test_the_title_of_a_study_counts_for_its_figures(folder):
    folder.write_study(CONDITIONS[0], is_listed=True)
    folder.run("all")
    folder.write_study(CONDITIONS[0].replace("title: Palm", "title: Hand"), is_listed=True)
    assert "1 figures_of_study" in folder.ask("why")
    folder.run("all")


def test_a_study_that_comes_back_is_an_input_of_a_new_report(folder):
    folder.write_study(CONDITIONS[0], is_listed=False)
    folder.run("study_palm")
    folder.set_parameter({"sensor": {"largest_size": 0.25}})
    folder.run("all")
    folder.set_parameter({"sensor": {"largest_size": 0.3}})
    other = folder.folder / "studies/hand.yaml"
    other.write_text(CONDITIONS[1])
    said = folder.snakemake("study_hand").stdout
    assert "leaves out" not in said
    folder.check("study_hand")
    other.unlink()


def test_a_lost_block_of_a_study_that_no_run_makes_is_no_reason_for_a_job(folder):
    folder.write_study(CONDITIONS[0], is_listed=False)
    folder.run("study_palm")
    folder.delete_folder("results/study_blocks/palm")
    folder.run("all")
    folder.run("study_palm")


def test_a_study_with_the_name_of_a_phase_is_not_asked_for_by_the_phase(folder):
    study = folder.folder / "studies/touches.yaml"
    study.write_text(CONDITIONS[0])
    folder.run("all")
    folder.run("touches_all")
    assert (folder.folder / "reports/report.html").exists()
    study.unlink()


def test_an_edit_of_a_file_beside_a_plug_in_reruns_its_phase(folder):
    folder.use_plug_in(True)
    folder.run("features_all")
    folder.edit_plug_in_or_a_file_beside("plug_ins/more/numbers.json", 2)
    folder.run("features_all")


def test_variables_of_another_run_change_nothing(folder):
    folder.enter_environment(
        {
            "VISUOHAPTIC_RUN": "elsewhere:1",
            "VISUOHAPTIC_PLUGINS": "/gone/plug_in.py",
            "VISUOHAPTIC_ARGUMENTS": '["study_ablations"]',
        }
    )
    folder.set_parameter({"sensor": {"largest_size": 0.2}})
    folder.run("all")


def test_files_of_the_future_do_not_stop_a_run(folder):
    folder.set_clock("both", "future")
    folder.edit_source(back=False)
    folder.set_clock("both", "future")
    folder.set_parameter({"sensor": {"largest_size": 0.2}})
    folder.run("all")
