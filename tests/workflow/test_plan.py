"""Jobs are planned from the rules' own words, and what no job writes goes."""

from types import SimpleNamespace

import pytest

from visuohaptic_workflow.plan import plan_jobs, prune_files, runs_jobs


class Named(list):
    """A list with names, as Snakemake has them."""

    def __init__(self, **named):
        super().__init__(named.values())
        self.__dict__.update(named)
        self._named = named

    def items(self):
        return self._named.items()


RULE = SimpleNamespace(
    input=Named(mesh="results/meshes/{object}.ply", extra=lambda asked: [f"{asked.object}.txt"]),
    output=Named(
        table="results/touches/{object}/{views}.parquet",
        pictures="results/touches/pictures/{object}/{views}",
        record="r/{object}/{views}.json",
    ),
    log=["logs/touches/{object}/{views}.log"],
    params=Named(seed=1, block=lambda asked: asked.views),
)
VALUES = {"object": ["cup/mug", "cup/jug"], "views": ["0-1"]}


def test_a_job_knows_its_files_and_parameters():
    job = plan_jobs({"touches": RULE}, VALUES, {})[0]
    assert job.inputs == ["results/meshes/cup/mug.ply", "cup/mug.txt"]
    assert job.outputs[0] == "results/touches/cup/mug/0-1.parquet"
    assert job.record == "r/cup/mug/0-1.json"
    assert job.logs == ["logs/touches/cup/mug/0-1.log"]
    assert job.params == {"seed": 1, "block": "0-1"}


def test_a_rule_may_have_values_of_its_own():
    assert len(plan_jobs({"touches": RULE}, VALUES, {})) == 2
    assert len(plan_jobs({"touches": RULE}, VALUES, {"touches": {"views": ["0", "1"]}})) == 4


def test_a_rule_without_a_record_is_left_out():
    rule = SimpleNamespace(output=Named(page="page.html"))
    assert plan_jobs({"page": rule}, VALUES, {}) == []


def test_what_no_job_writes_goes_and_a_users_own_file_stays(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    names = (
        "results/touches/cup/mug/0-1.parquet",
        "results/touches/pictures/cup/mug/0-1/a.parquet",
        "results/touches/cup/gone/0-1.parquet",
        "results/touches/cup/mug/.0-1.parquet-tmp",
        "results/touches/cup/notes.txt",
        "results/mine.parquet",
        "logs/touches/cup/gone/0-1.log",
    )
    for name in names:
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.touch()
    prune_files(plan_jobs({"touches": RULE}, VALUES, {}), ["results", "logs"])
    assert [(tmp_path / name).exists() for name in names] == [
        True,
        True,
        False,
        False,
        True,
        True,
        False,
    ]
    assert not (tmp_path / "results/touches/cup/gone").exists()


@pytest.mark.parametrize(
    "line", ["-j2", "-c1 touches_all", "--rerun-incomplete", "-j2 -k", "-dnight", "-Rnoise", ""]
)
def test_these_command_lines_run_jobs(line):
    assert runs_jobs(["snakemake", *line.split()])


@pytest.mark.parametrize(
    "line", ["-n", "-np", "-j2 -n", "--dry-run", "--lint", "--dag=dot", "-pn", "-kn", "-fn"]
)
def test_these_command_lines_run_none(line):
    assert not runs_jobs(["snakemake", *line.split()])
