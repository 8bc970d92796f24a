"""`visuohaptic report` writes a finished run's page, and names what is missing."""

import json
import shutil

import pytest
from report.pages import read_page
from report.synthetic import lay_out

KEYS = ("cup/mug", "cup/<script>alert(1)<", "ball/..-x", "ball/Kännchen 茶")


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    return lay_out(tmp_path_factory.mktemp("run"), KEYS)


@pytest.mark.slow
def test_the_page_of_a_run_is_one_file_that_leaves_nothing_outside_its_folder(
    visuohaptic, tmp_path, run
):
    before = {path for path in run.rglob("*") if path.is_file()}
    ended = visuohaptic("report", run, "--out", "page")
    assert (ended.code, ended.err) == (0, "")
    assert ended.out.startswith("page/report.html: 4 objects, ")
    file = tmp_path / "page" / "report.html"
    assert [path for path in tmp_path.rglob("*") if path.is_file()] == [file]
    assert {path for path in run.rglob("*") if path.is_file()} == before
    assert set(read_page(file.read_text()).objects) == set(KEYS)
    values = json.loads(visuohaptic("report", run, "--json").out)
    assert values["bytes"] == (tmp_path / values["page"]).stat().st_size
    assert values["objects"] == sorted(KEYS)


@pytest.mark.parametrize("lost", ["params.yaml", "reports/metrics.json", "results/touches"])
def test_what_a_run_lacks_is_named_with_the_way_out(visuohaptic, tmp_path, run, lost):
    copy = shutil.copytree(run, tmp_path / "run")
    path = copy / lost
    shutil.rmtree(path) if path.is_dir() else path.unlink()
    ended = visuohaptic("report", "run")
    assert ended.code == 1
    assert ended.err.startswith(f"error: run/{lost} does not exist")
    assert "snakemake -j2" in ended.err
    assert not (tmp_path / "report").exists()
