"""`visuohaptic export`: `datasets` reads what it wrote, and a folder of other files is refused."""

import json
import re
import shutil

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
import yaml
from recognition.synthetic import with_column
from report.synthetic import lay_out

from visuohaptic.tables.phases import FEATURES, TOUCHES
from visuohaptic.tables.schema import images, read_table, write_table

KEYS = ("cup/mug", "cup/a|b", 'ball/\'y: "z"', "ball/Kännchen 茶")


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    folder = lay_out(tmp_path_factory.mktemp("run"), KEYS)
    credits_file = folder / "meshes/paper/credits.csv"
    credits_file.parent.mkdir(parents=True)
    credits_file.write_text(
        "class,object,author,licence,source_url\n"
        'cup,mug,"Ada, ""Countess""\nof Lovelace",CC-BY-3.0-US,https://example.org\n'
        "ball,Kännchen 茶,Bob,My own terms,\n"
    )
    return folder


@pytest.fixture
def run(finished, tmp_path):
    return shutil.copytree(finished, tmp_path / "run")


def test_datasets_reads_touches_and_features_as_they_are_in_the_run(visuohaptic, run, tmp_path):
    datasets = pytest.importorskip("datasets")
    assert visuohaptic("export", "out", folder=run).code == 0

    def load(name):
        folder, cache = str(run / "out"), str(tmp_path / "cache")
        return datasets.load_dataset(folder, name, split="train", cache_dir=cache)

    touches = pq.read_table(run / "results/touches/all.parquet")
    stored = load("touches")
    assert np.array_equal(stored.with_format("numpy")["imprint"][:], images(touches))
    shaped = datasets.Array2D((32, 32), "float32")
    assert stored.cast_column("imprint", shaped).features["imprint"] == shaped
    table = stored.remove_columns("imprint").data.table
    assert table.equals(touches.drop_columns("image").cast(table.schema))
    features = load("features").data.table
    assert features.equals(read_table(FEATURES, run / "results/features").cast(features.schema))


def test_two_parquet_files_and_a_card_are_written(visuohaptic, run, monkeypatch):
    monkeypatch.setattr("visuohaptic.cli.export.ROWS", 7)
    ended = visuohaptic("export", "out", folder=run)
    assert re.fullmatch(r"out: 160 touches of 4 objects, \d\.\d MB\n", ended.out)
    names = {"README.md", "features.parquet", "touches.parquet"}
    assert {file.name for file in (run / "out").iterdir()} == names
    stored = pq.read_table(run / "out/touches.parquet").column("imprint").to_pylist()
    touches = pq.read_table(run / "results/touches/all.parquet")
    assert np.array_equal(np.array(stored, "f4"), images(touches))
    values = json.loads(visuohaptic("export", "again", "--json", folder=run).out)
    assert (values["touches"], values["objects"]) == (160, 4)


def test_the_card_names_licences_and_authors_and_no_name_can_break_it(visuohaptic, run):
    visuohaptic("export", "out", folder=run)
    _, header, text = (run / "out/README.md").read_text().split("---\n", 2)
    header = yaml.safe_load(header)
    assert header["license"] == ["cc-by-3.0", "other", "unknown"]
    assert {one["data_files"] for one in header["configs"]} == {
        "touches.parquet", "features.parquet",
    }  # fmt: skip
    line = '| cup/mug | Ada, "Countess" of Lovelace | CC-BY-3.0-US | https://example.org |'
    assert line in text.splitlines()
    assert r"| cup/a\|b | not known | not known | not known |" in text.splitlines()


@pytest.mark.parametrize("name", ["README.md", "touches.parquet", ".git/config"])
def test_a_folder_that_holds_anything_is_refused_and_left_as_it_is(visuohaptic, run, name):
    file = run / "mine" / name
    file.parent.mkdir(parents=True)
    file.write_text("mine")
    ended = visuohaptic("export", "mine", folder=run)
    assert ended.code == 1
    assert "is there already; name a new or an empty folder" in ended.err
    assert [path for path in (run / "mine").rglob("*") if path.is_file()] == [file]


def test_an_unfinished_run_is_refused_in_one_sentence(visuohaptic, run, tmp_path):
    assert "results/touches holds no touches" in visuohaptic("export", "out").err
    touches = read_table(TOUCHES, run / "results/touches")
    small = [image[:256] for image in touches["image"].to_pylist()]
    halved = with_column(touches, "image", pa.array(small, touches["image"].type))
    write_table(TOUCHES, halved, run / "results/touches/other.parquet")
    assert "other.parquet has imprints of 16 x 16" in visuohaptic("export", "out", folder=run).err
    write_table(TOUCHES, touches[:5], run / "results/touches/other.parquet")
    ended = visuohaptic("export", "out", folder=run)
    assert "165 touches and 160 rows of features; run `snakemake -j2`" in ended.err
    assert list((run / "out").iterdir()) == []


def test_touches_and_features_of_other_touches_are_refused(visuohaptic, run):
    touches = read_table(TOUCHES, run / "results/touches")
    viewpoint = touches["viewpoint"].to_numpy() + 7
    other = with_column(touches, "viewpoint", pa.array(viewpoint, touches["viewpoint"].type))
    (run / "results/touches/all.parquet").unlink()
    write_table(TOUCHES, other, run / "results/touches/other.parquet")
    ended = visuohaptic("export", "out", folder=run)
    assert "results/touches and results/features hold other touches" in ended.err
    assert list((run / "out").iterdir()) == []


def test_taxels_of_a_pad_are_written_in_one_row(visuohaptic, run):
    file = run / "results/touches/all.parquet"
    touches = pq.read_table(file)
    values = np.random.default_rng(0).random((touches.num_rows, 127), dtype=np.float32)
    lists = pa.array(values.tolist(), TOUCHES.arrow.field("image").type)
    index = touches.schema.get_field_index("image")
    write_table(TOUCHES, touches.set_column(index, TOUCHES.arrow.field("image"), lists), file)
    assert visuohaptic("export", "out", folder=run).code == 0
    written = pq.read_table(run / "out/touches.parquet").column("imprint").to_pylist()
    np.testing.assert_array_equal(np.array(written, dtype=np.float32), values[:, None])
