"""`visuohaptic export` says what it wrote, and refuses a folder of other files in one sentence."""

import json

import pytest
from report.synthetic import lay_out


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    return lay_out(tmp_path_factory.mktemp("run"))


def test_a_run_becomes_a_data_set(visuohaptic, run, tmp_path):
    ended = visuohaptic("export", "touches", "--run", run)
    assert (ended.code, ended.err) == (0, "")
    assert ended.out.startswith(
        "touches: 160 touches of 4 objects in 2 classes, 2 objects to test; "
    )
    assert "no licence is known for 4 objects" in ended.out
    values = json.loads(visuohaptic("export", "touches", "--run", run, "--json").out)
    files = [*(tmp_path / "touches/lite").iterdir()]
    assert values["bytes"]["lite"] == sum(file.stat().st_size for file in files)
    assert (values["touches"], values["objects"], len(values["test_objects"])) == (160, 4, 2)


def test_a_folder_without_a_run_is_named_with_the_way_out(visuohaptic, run, tmp_path):
    (tmp_path / "params.yaml").write_text((run / "params.yaml").read_text())
    ended = visuohaptic("export", "touches")
    assert ended.code == 1
    assert "results/touches holds no touches" in ended.err
    assert not (tmp_path / "touches").exists()
