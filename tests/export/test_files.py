"""A run's touches as a data set: schema, pictures, splits, credits, and whose folder may be replaced."""

import csv
import hashlib
import io
import json
import shutil
from collections import Counter

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.parquet as pq
import pytest
import yaml
from PIL import Image
from recognition.synthetic import with_column
from report.synthetic import lay_out

from visuohaptic.errors import ExportError
from visuohaptic.export import contents as export_contents
from visuohaptic.export.card import MARK
from visuohaptic.export.experiment import read_experiment
from visuohaptic.export.files import FILES, PARQUET, export_run, make_export
from visuohaptic.tables.phases import FEATURES, PREDICTIONS, TOUCHES
from visuohaptic.tables.schema import images, read_table, write_table

BALLS = ("ball/<b>x</b>", "ball/Kännchen 茶", 'ball/\'y: "z"')
KEYS = ("cup/mug", "cup/a|b", "cup/c", *BALLS, "one/one")
COMMIT = "0123456789abcdef0123456789abcdef01234567"
ODD = 'ball | "of" <b>: #'


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    folder = lay_out(tmp_path_factory.mktemp("run"), KEYS)
    credits_file = folder / "meshes/paper/credits.csv"
    credits_file.parent.mkdir(parents=True)
    credits_file.write_text(
        "class,object,author,licence,source_url\n"
        'cup,mug,"Ada, ""Countess""\nof Lovelace",CC-BY-3.0,https://example.org\n'
        "cup,c,Bob,My own terms,\n"
    )
    return folder


@pytest.fixture(scope="module")
def exported(run, tmp_path_factory):
    folder = tmp_path_factory.mktemp("out") / "export"
    export_run(run, folder, COMMIT)
    return folder


@pytest.fixture(scope="module")
def experiment(run):
    return read_experiment(
        [run / "results/features"], [run / "results/predictions"], run / "reports/metrics.json",
        {"seed": 1}, COMMIT,
    )  # fmt: skip


def rows_of(folder, configuration="data"):
    """Read both splits."""
    files = {split: folder / configuration / f"{split}.parquet" for split in ("train", "test")}
    return {split: pq.read_table(file) for split, file in files.items()}


def owners(table):
    return set(zip(*(table.column(name).to_pylist() for name in ("class", "object")), strict=True))


def header(folder):
    return yaml.safe_load((folder / "README.md").read_text().split("---\n")[1])


def contents_of(folder):
    return {path: path.read_bytes() for path in sorted(folder.rglob("*")) if path.is_file()}


def test_every_touch_is_there_once_with_its_imprint_as_picture_and_in_full(run, exported):
    rows = pa.concat_tables(rows_of(exported).values())
    rows = rows.sort_by([(key, "ascending") for key in TOUCHES.keys])
    touches = read_table(TOUCHES, run / "results/touches")
    for name in (*TOUCHES.keys, "sensor_size", "x", "tangent_z"):
        assert rows.column(name).to_pylist() == touches.column(name).to_pylist()
    imprints = images(touches)
    np.testing.assert_array_equal(np.array(rows.column("imprint").to_pylist(), "f4"), imprints)
    for stored, imprint in zip(rows.column("image").to_pylist(), imprints, strict=True):
        picture = Image.open(io.BytesIO(stored["bytes"]))
        assert (picture.mode, picture.size, picture.format) == ("L", (32, 32), "PNG")
        assert np.abs(np.asarray(picture) / 255 - imprint).max() <= 0.5 / 255 + 1e-7


def test_no_object_is_in_two_splits_and_each_class_with_two_objects_is_in_both(exported):
    for configuration in ("data", "lite"):
        train, test = map(owners, rows_of(exported, configuration).values())
        assert not train & test
        assert {"/".join(owner) for owner in train | test} == set(KEYS)
        assert {owner[0] for owner in test} == {"ball", "cup"}
        assert {owner[0] for owner in train} == {"ball", "cup", "one"}


def test_labels_are_the_names_in_the_header_and_types_are_those_of_the_files(exported):
    described = {
        entry["config_name"]: entry["features"] for entry in header(exported)["dataset_info"]
    }
    for configuration, features in (("data", described["default"]), ("lite", described["lite"])):
        dtypes = {feature["name"]: feature["dtype"] for feature in features}
        names = dtypes["label"]["class_label"]["names"]
        for table in rows_of(exported, configuration).values():
            assert table.schema.names == list(dtypes)
            for row in table.select(["label", "class"]).to_pylist():
                assert names[str(row["label"])] == row["class"]
    assert dtypes["image"] == "image"
    assert (dtypes["viewpoint"], dtypes["x"], dtypes["class"]) == ("int32", "float64", "string")
    assert "imprint" not in dtypes
    imprint = described["default"][-1]
    assert imprint["dtype"] == {"array2_d": {"shape": [32, 32], "dtype": "float32"}}


def test_the_header_names_the_files_of_each_split_and_no_others_are_written(exported):
    found = [file["path"] for entry in header(exported)["configs"] for file in entry["data_files"]]
    assert tuple(found) == PARQUET
    assert {path.relative_to(exported).as_posix() for path in contents_of(exported)} == set(FILES)


def test_licences_and_authors_stand_by_object_in_each_row_and_in_the_card(exported):
    with (exported / "credits.csv").open(newline="", encoding="utf-8") as stream:
        credited = {f"{row['class']}/{row['object']}": row for row in csv.DictReader(stream)}
    assert set(credited) == set(KEYS)
    assert credited["cup/mug"]["author"] == 'Ada, "Countess"\nof Lovelace'
    assert credited["one/one"]["licence"] == credited["one/one"]["author"] == ""
    for split, table in rows_of(exported).items():
        names = ("class", "object", "author", "licence")
        for row in table.select(names).to_pylist():
            entry = credited[f"{row['class']}/{row['object']}"]
            assert {**row, "split": split}.items() <= entry.items()
    assert header(exported)["license"] == ["cc-by-3.0", "other"]
    assert "| not known" in (exported / "README.md").read_text()


def test_croissant_describes_every_file_and_column_by_its_bytes(exported):
    described = json.loads((exported / "croissant.json").read_text())
    files = {entry["@id"]: entry for entry in described["distribution"]}
    assert tuple(files) == PARQUET
    for name, entry in files.items():
        assert entry["sha256"] == hashlib.sha256((exported / name).read_bytes()).hexdigest()
    for fields in (record_set["field"] for record_set in described["recordSet"]):
        file = fields[0]["source"]["fileObject"]["@id"]
        names = pq.read_schema(exported / file).names
        assert [field["source"]["extract"]["column"] for field in fields] == names
        arrays = {field["name"]: field["arrayShape"] for field in fields if "isArray" in field}
        assert arrays == ({"imprint": "32,32"} if "imprint" in names else {})


def test_two_exports_are_the_same_bit_for_bit_in_any_order_of_the_parts(run, experiment, tmp_path):
    touches = read_table(TOUCHES, run / "results/touches")
    half = touches.num_rows // 2
    parts = [tmp_path / "a.parquet", tmp_path / "b.parquet"]
    write_table(TOUCHES, touches.slice(0, half), parts[0])
    write_table(TOUCHES, touches.slice(half), parts[1])
    first, second = tmp_path / "first", tmp_path / "second"
    make_export(parts, [], first, 1, experiment)
    make_export(parts[::-1], [], second, 1, experiment)
    assert [*contents_of(first).values()] == [*contents_of(second).values()]


def test_another_seed_may_draw_other_test_objects_and_other_classes_change_none():
    keys = [f"{name}/{number}" for name in "ab" for number in range(10)]
    drawn = {tuple(sorted(export_contents.choose_tested(keys, seed))) for seed in range(9)}
    assert len(drawn) > 1
    assert all(len(tested) == 4 for tested in drawn)
    alone = export_contents.choose_tested(keys[:10], 0)
    assert alone == export_contents.choose_tested(keys, 0)[:2]


def test_the_lite_version_has_all_strategies_of_a_view_or_none(run, tmp_path, monkeypatch):
    touches = read_table(TOUCHES, run / "results/touches").num_rows
    monkeypatch.setattr(export_contents, "LITE_BYTES", touches * (32**2 + 768) / 2)
    export_run(run, tmp_path / "lite", COMMIT)
    rows = pa.concat_tables(rows_of(tmp_path / "lite", "lite").values())
    assert rows.num_rows == pytest.approx(touches / 2, abs=10)
    assert set(Counter(rows.column("strategy").to_pylist()).values()) == {rows.num_rows // 2}


def test_features_are_those_of_the_run_and_classify_as_there(run, exported, experiment):
    features = read_table(FEATURES, exported / "features/run.parquet")
    assert features.equals(experiment.features)
    held = json.loads((exported / "experiment.json").read_text())
    assert held["parameters"]["seed"] == 2018
    assert held["commit"] == COMMIT
    metrics = json.loads((run / "reports/metrics.json").read_text())["results"]
    for one in held["baselines"]:
        figure = metrics[one["pipeline"]][one["strategy"]][one["classifier"]]["accuracy"]
        assert (one["accuracy"], one["low"]) == (figure["mean"], figure["low"])
        assert one["classifier"] in (exported / "README.md").read_text()
    predictions = read_table(PREDICTIONS, run / "results/predictions")
    for split, tested in enumerate(held["tested_objects"]):
        rows = predictions.filter(pc.equal(predictions.column("split"), split))
        assert tested == sorted({"/".join(owner) for owner in owners(rows)})


def test_a_run_without_metrics_is_refused(run, tmp_path):
    with pytest.raises(ExportError, match="is no metrics of a run"):
        read_experiment([], [], tmp_path / "metrics.json", {}, COMMIT)


def test_an_earlier_export_is_replaced_and_an_interrupted_one_too(run, exported, tmp_path):
    copy = shutil.copytree(exported, tmp_path / "export")
    (copy / "data/test.parquet").unlink()
    (copy / "lite/train.parquet").write_bytes(b"half")
    export_run(run, copy, COMMIT)
    assert [*contents_of(copy).values()] == [*contents_of(exported).values()]


@pytest.mark.parametrize(
    "stranger", ["README.md", "notes.txt", "data/train.parquet", "data/x.csv", ".git/config"]
)
def test_a_folder_with_anything_else_is_refused_and_left_as_it_is(run, tmp_path, stranger):
    file = tmp_path / "mine" / stranger
    file.parent.mkdir(parents=True)
    file.write_text("mine")
    with pytest.raises(ExportError, match=r"mine (holds|is not empty)"):
        export_run(run, tmp_path / "mine", COMMIT)
    assert contents_of(tmp_path / "mine") == {file: b"mine"}


@pytest.mark.parametrize("name", ["data/more.parquet", "data", "README.md"])
def test_an_export_with_a_link_in_it_or_a_file_of_others_is_refused(run, exported, tmp_path, name):
    copy = shutil.copytree(exported, tmp_path / "export")
    if (copy / name).exists():
        (copy / name).symlink_to(shutil.move(copy / name, tmp_path / "elsewhere"))
    else:
        (copy / name).write_text("mine")
    before = contents_of(tmp_path)
    with pytest.raises(ExportError, match=f"{name}, which is no part of an export"):
        export_run(run, copy, COMMIT)
    assert contents_of(tmp_path) == before


def test_names_can_not_write_the_card(run, experiment, tmp_path):
    touches = read_table(TOUCHES, run / "results/touches")
    names = [ODD if name == "ball" else name for name in touches.column("class").to_pylist()]
    write_table(TOUCHES, with_column(touches, "class", names), tmp_path / "t.parquet")
    folder = tmp_path / "out"
    make_export([tmp_path / "t.parquet"], [], folder, 1, experiment)
    label = header(folder)["dataset_info"][0]["features"][1]["dtype"]["class_label"]
    assert ODD in label["names"].values()
    card = (folder / "README.md").read_text().split(MARK)[1]
    assert ODD not in card
    assert r"| ball \| " in card


def test_what_can_not_be_exported_is_said_before_anything_is_written(run, experiment, tmp_path):
    touches, whole = read_table(TOUCHES, run / "results/touches"), "results/touches/all.parquet"
    small = [image[:256] for image in touches["image"].to_pylist()]
    halved = with_column(touches, "image", pa.array(small, touches["image"].type))
    for name, part in (("none", touches[:0]), ("one", touches[:5]), ("other", halved)):
        write_table(TOUCHES, part, tmp_path / f"{name}.parquet")
    for parts, folder, reason in (
        (["none.parquet"], "out", "no touch"),
        (["one.parquet"], "out", "one object"),
        ([run / whole, "other.parquet"], "out", r"other.parquet has imprints of 16 × 16"),
        ([run / whole], "one.parquet", "is a file"),
    ):
        with pytest.raises(ExportError, match=reason):
            make_export([tmp_path / part for part in parts], [], tmp_path / folder, 1, experiment)
    assert not (tmp_path / "out").exists()
