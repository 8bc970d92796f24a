"""The section on gaze shows what was measured, and says where kept figures come from."""

import numpy as np
from gaze.made_up import made_up_object
from visuohaptic.gaze.measuring import measure_all
from visuohaptic.gaze.parameters import GazeParameters
from visuohaptic.gaze.stored import MeasuredGaze, read_measured
from visuohaptic.tables.gaze import GAZE_PICTURES

from visuohaptic.report.gaze import gaze_figures
from visuohaptic.report.page import make_environment
from visuohaptic.tables.schema import build_table, write_table

OBJECTS = [
    *(made_up_object(f"thing{chr(97 + n)}", "height", n) for n in range(4)),
    made_up_object("new", "height", 9, is_test=True),
]
TABLE = measure_all(OBJECTS, GazeParameters(folds=2))


def page(found):
    return make_environment().get_template("gaze.html.jinja").render(gaze=found)


def test_the_section_shows_each_predictor_and_the_worst_objects():
    assert gaze_figures(None) is None
    assert "gaze.folder" in page(None)
    found = gaze_figures(MeasuredGaze(TABLE))
    text = page(found)
    assert all(row.predictor.label in text for row in found["rows"])
    assert [row.objects for row in found["rows"]] == [4] * len(found["rows"])
    correlations = [one["correlation"] for one in found["worst"]]
    assert correlations == sorted(correlations)
    assert "1 object for tests" in text
    assert "Measured once" not in text


def test_pictures_are_shown_worst_first_and_kept_figures_say_where_they_come_from(tmp_path):
    columns = {"object": ["good", "bad<"], "rank": np.array([3, 0], dtype=np.int32)}
    columns |= {"correlation": [0.9, 0.1], "picture": [b"\x89PNG1", b"\x89PNG2"]}
    path = tmp_path / "pictures.parquet"
    write_table(GAZE_PICTURES, build_table(GAZE_PICTURES, columns), path)
    origin = {"date": "2026-01-02", "command": "measure <it>", "source": "recordings"}
    found = gaze_figures(MeasuredGaze(TABLE, origin), path)
    assert [one["object"] for one in found["pictures"]] == ["bad<", "good"]
    text = page(found)
    for said in ("bad&lt;", "data:image/png;base64,", "2026-01-02", "measure &lt;it&gt;"):
        assert said in text


def test_what_is_kept_with_the_package_has_an_origin_and_no_test_data_of_its_own():
    kept = read_measured(None)
    assert set(kept.origin) == {"date", "command", "source"}
    digests, objects = (set(kept.table.column(name).to_pylist()) for name in ("digest", "object"))
    assert len(digests) == len(objects)
