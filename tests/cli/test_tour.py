"""Every command of docs/tour.md runs, in the order of the page."""

import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
import trimesh
import yaml
from recognition.synthetic import features_table
from report.synthetic import lay_out

from visuohaptic.evaluation.summary import select
from visuohaptic.tables.phases import FEATURES
from visuohaptic.tables.schema import write_table

ROOT = Path(__file__).parents[2]
BLOCKS = re.findall(r"```(\w+)\n(.*?)```", (ROOT / "docs" / "tour.md").read_text(), re.DOTALL)
COMMANDS = [line for kind, text in BLOCKS if kind == "sh" for line in text.splitlines()]
SNAKEFILE = """
configfile: "params.yaml"
include: "workflow/rules/common.smk"
include: "workflow/rules/study_conditions.smk"
include: "workflow/rules/model.smk"
"""
HEADER = (ROOT / "meshes/catalogue.csv").read_text().splitlines()[0]


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A checkout in which the features of four objects are there already."""
    folder = tmp_path_factory.mktemp("tour")
    for name in ("src", "packages", "workflow"):
        (folder / name).symlink_to(ROOT / name)
    (folder / "Snakefile").write_text(SNAKEFILE)
    parameters = yaml.safe_load((ROOT / "params.yaml").read_text())
    parameters["viewpoints"]["count"] = 2
    parameters["rendering"]["resolution"] = 64
    # So that each object's features are a file of their own.
    parameters["workflow"] |= {"views_per_job": 2, "objects_per_job": 1}
    (folder / "params.yaml").write_text(yaml.safe_dump(parameters))
    features = features_table(objects=(2, 2), viewpoints=2)
    for owner in features.group_by(["class", "object"]).aggregate([]).to_pylist():
        model = folder / "meshes/own" / owner["class"] / f"{owner['object']}.obj"
        model.parent.mkdir(parents=True, exist_ok=True)
        model.touch()
        part = folder / "results/features" / owner["class"] / model.stem
        write_table(FEATURES, select(features, **owner), part / "00-01.parquet")
    (folder / "meshes" / "catalogue.csv").write_text(f"{HEADER}\n")
    (folder / "before").mkdir()
    lay_out(folder / "before")
    (folder / "reports").mkdir()
    shutil.copy(folder / "before/reports/metrics.json", folder / "reports")
    trimesh.creation.annulus(0.8, 1, 2).export(folder / "mug.obj")
    return folder


@pytest.mark.slow
@pytest.mark.long
def test_the_tour_runs_from_end_to_end(folder, visuohaptic, monkeypatch):
    monkeypatch.chdir(folder)
    for command in COMMANDS:
        program, *arguments = shlex.split(command)
        if program == "snakemake":
            run_snakemake(folder, arguments)
            continue
        assert program == "visuohaptic"
        ended = visuohaptic(*arguments)
        assert ended.code == 0, ended.err
    for kind, text in BLOCKS:
        if kind == "python":
            exec(compile(text, "docs/tour.md", "exec"), {})  # noqa: S102
    made = ("mug/picture.png", "random/features.parquet", "page/report.html", "mug.png")
    made += ("runs.csv", "pressed/imprints.npy", "pressed.png")
    assert all((folder / name).is_file() for name in made)


def run_snakemake(folder, arguments):
    result = subprocess.run(
        [sys.executable, "-m", "snakemake", *arguments],
        cwd=folder, check=False, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
    )  # fmt: skip
    assert result.returncode == 0, result.stdout[-3000:]
    assert (folder / "results/models/recogniser.skops").is_file()


def test_the_tour_shows_every_command():
    shown = {command.split()[1] for command in COMMANDS if command.startswith("visuohaptic")}
    assert shown == {"touch", "press", "recognise", "report", "compare"}
