"""Objects in blocks give the files that jobs of their own give, and a broken one stops itself alone."""

import os
import time

import pytest

from visuohaptic_workflow.object_blocks import divide, files_of, is_untouched

BLOCKS = {"objects_per_job": 3}
BROKEN = "chair/bsby_chair3"
BREAKS = f"""

if snakemake.wildcards.object == "{BROKEN}":
    raise SystemExit("error: it is broken.")
"""


def test_blocks_hold_each_object_once_in_order():
    objects = [f"cup/{number}" for number in range(7)]
    assert divide(objects, 3) == {
        "0000-0002": objects[:3],
        "0003-0005": objects[3:6],
        "0006-0006": objects[6:],
    }
    assert divide(objects, None) == {}


def test_lists_stand_for_the_files_that_they_name(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    path = tmp_path / "results/blocks/0000-0001/meshes.json"
    path.parent.mkdir(parents=True)
    path.write_text('{"a.ply": "1", "b.ply": "2"}')
    inputs = ["results/blocks/0000-0001/meshes.json", "c.ply"]
    assert files_of(inputs) == ["a.ply", "b.ply", "c.ply"]
    assert files_of(inputs, sample=["a.ply", "gone.ply"]) == ["a.ply", "c.ply"]


def test_a_file_that_is_missing_or_changed_since_is_noticed(tmp_path):
    file, record = tmp_path / "a", tmp_path / "record"
    file.write_text("1")
    record.write_text("1")
    assert is_untouched(str(record), [str(file)])
    time.sleep(0.02)
    file.write_text("2")
    os.utime(file, (1, 1))  # as old as it may look
    assert not is_untouched(str(record), [str(file)])
    file.unlink()
    assert not is_untouched(str(record), [str(file)])


@pytest.mark.workflow
def test_of_many_objects_the_frontier_takes_a_sample(fresh, tmp_path):
    experiment = fresh.copy(tmp_path / "experiment")
    for name in ("d", "e"):
        own = experiment.folder / f"meshes/own/bottle/{name}.ply"
        own.parent.mkdir(exist_ok=True)
        own.write_bytes(b"")
    for maximum, taken in ((3, 4), (6, 6)):
        experiment.set(cost={"maximum_objects": maximum})
        planned = experiment.planned("frontier_all")
        assert planned["features"] == planned["meshes"] == taken
        assert planned["features_of_study"] == 1


def untimed(experiment):
    """Give the digests of results, but for tables that hold seconds."""
    timed = ("frontier", "effect_influence")
    return {
        name: digest
        for name, digest in experiment.digests().items()
        if not any(word in name for word in timed)
    }


def features_of(experiment):
    """Give the bytes of each part of the features."""
    folder = experiment.folder / "results/features"
    return {str(file.relative_to(folder)): file.read_bytes() for file in folder.rglob("*.parquet")}


@pytest.fixture(scope="module")
def in_blocks(fresh, tmp_path_factory):
    """The experiment run in blocks."""
    experiment = fresh.copy(tmp_path_factory.mktemp("blocks") / "experiment")
    experiment.set(workflow=BLOCKS)
    experiment.snakemake()
    return experiment


@pytest.mark.long
@pytest.mark.workflow
def test_blocks_change_no_file_and_leave_nothing_to_do(in_blocks, finished):
    assert untimed(in_blocks) == untimed(finished)
    assert in_blocks.planned() == {}
    records = finished.folder / "results/records"
    for rule in ("meshes", "features", "stability"):  # the other rules write seconds, too
        for record in sorted((records / rule).rglob("*.json")):
            other = in_blocks.folder / record.relative_to(finished.folder)
            assert other.read_bytes() == record.read_bytes()


@pytest.mark.workflow
def test_without_blocks_what_blocks_made_is_kept(in_blocks, tmp_path):
    experiment = in_blocks.copy(tmp_path / "experiment")
    experiment.set(workflow={"objects_per_job": None})
    planned = experiment.planned()
    assert not {"meshes", "fixations", "touches", "features", "stability_of_object"} & set(planned)


@pytest.mark.workflow
@pytest.mark.long
def test_a_block_makes_a_lost_file_again_and_leaves_the_others(in_blocks):
    touches = in_blocks.folder / "results/touches" / BROKEN / "00-01.parquet"
    fixations = in_blocks.folder / "results/fixations" / BROKEN / "00-01.parquet"
    made, looked = touches.read_bytes(), fixations.stat().st_mtime_ns
    touches.unlink()
    assert in_blocks.planned()["objects"] == 1
    in_blocks.snakemake()
    assert touches.read_bytes() == made
    assert fixations.stat().st_mtime_ns == looked
    assert in_blocks.planned() == {}


@pytest.mark.workflow
@pytest.mark.long
def test_a_broken_object_stops_itself_alone(fresh, finished, tmp_path):
    experiment = fresh.copy(tmp_path / "experiment")
    experiment.set(workflow={"objects_per_job": 4})
    script = experiment.folder / "workflow/scripts/fixations.py"
    whole = script.read_text()
    head, _, rest = whole.partition("with job(")
    script.write_text(f"{head}{BREAKS}\nwith job({rest}")
    result = experiment.snakemake("features_all", check=False)
    assert result.returncode != 0
    assert f"1 of 4 objects failed: {BROKEN}; the others are done." in result.stdout
    whole_features = features_of(finished)
    broken = f"{BROKEN}/00-01.parquet"
    assert broken in whole_features
    assert features_of(experiment) == {
        name: table for name, table in whole_features.items() if name != broken
    }
    assert (experiment.folder / "results/meshes" / f"{BROKEN}.ply").exists()
    script.write_text(whole)
    experiment.snakemake("features_all")
    assert features_of(experiment) == whole_features
