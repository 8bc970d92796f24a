"""What the page shows of each object is made from its views, touches and mesh."""

import io

import numpy as np
from PIL import Image
from report.synthetic import OBJECTS, STRATEGIES, TOUCHES, VIEWPOINTS, write_run

from visuohaptic.pictures.object_pictures import make_pictures
from visuohaptic.tables.phases import TOUCHES as TOUCHED
from visuohaptic.tables.phases import key_of
from visuohaptic.tables.pictures import PICTURES
from visuohaptic.tables.schema import build_table, read_table, write_table
from visuohaptic.tables.stability import STABILITY


def size(picture):
    return Image.open(io.BytesIO(picture)).size


def test_every_object_that_was_looked_at_has_its_pictures_and_its_model(tmp_path):
    rows = read_table(PICTURES, write_run(tmp_path).pictures).to_pylist()
    assert {key_of(row) for row in rows} == set(OBJECTS)
    for row in rows:
        for name in ("views", "saliency", "imprints"):
            assert sorted(dict(row[name])) == list(range(VIEWPOINTS))
        sheets = dict(row["sheets"])
        assert set(sheets) == set(STRATEGIES)
        assert {size(sheet) for sheet in sheets.values()} == {(32 * TOUCHES, 32 * VIEWPOINTS)}
        assert row["touches"] == len(STRATEGIES) * VIEWPOINTS * TOUCHES
        assert row["faces"] == row["original_faces"]


def test_a_model_has_few_faces_and_views_that_were_not_touched_no_imprints(tmp_path):
    files = write_run(tmp_path, OBJECTS[:2])
    touches = read_table(TOUCHED, files.touches)
    seen = touches.column("viewpoint").to_numpy()
    write_table(TOUCHED, touches.filter(np.asarray(seen != 2)), tmp_path / "fewer.parquet")
    meshes, output = {OBJECTS[0]: files.meshes[0]}, tmp_path / "few.parquet"
    tables = files.views, [tmp_path / "fewer.parquet"], tmp_path / "held.parquet"
    make_pictures(meshes, *tables, output, shown=OBJECTS, faces=60)
    rows = {key_of(row): row for row in read_table(PICTURES, output).to_pylist()}
    with_model, without = (rows[key] for key in OBJECTS[:2])
    assert sorted(dict(with_model["imprints"])) == [0, 1, 3]
    assert 0 < with_model["faces"] <= 60 < with_model["original_faces"]
    assert (without["model"], without["sheets"]) == (None, [])


def test_objects_that_are_not_shown_have_pictures_where_they_exceed_a_tolerance(tmp_path):
    files = write_run(tmp_path)
    shown, over, infinite, held = OBJECTS
    checks = {
        "requirement": "frames", "cases": 1, "tolerance": 1.0,
        "class": [key.split("/")[0] for key in (over, infinite, held)],
        "object": [key.split("/")[1] for key in (over, infinite, held)],
        "worst_error": [1.5, None, 1.0],
        **dict.fromkeys(("unit", "reason", "hardest"), ""),
    }  # fmt: skip
    write_table(STABILITY, build_table(STABILITY, checks), tmp_path / "checks.parquet")
    tables = files.views, files.touches, tmp_path / "checks.parquet"
    make_pictures({}, *tables, tmp_path / "few.parquet", shown=[shown], faces=60)
    found = map(key_of, read_table(PICTURES, tmp_path / "few.parquet").to_pylist())
    assert set(found) == {shown, over, infinite}
