"""The page tells what effects cost and change where it was measured, and shows hard places always."""

import pytest
from report.pages import read_page
from report.synthetic import OBJECTS, PARAMETERS, write_run

from visuohaptic.report.influence import accuracy_rows, hard_places, influence_figures
from visuohaptic.report.page import render_page
from visuohaptic.report.run import RunFiles, read_run
from visuohaptic.sensor import CONTACT_STATES, hard_probes
from visuohaptic.tables.schema import build_table, write_table
from visuohaptic.tables.studies import EFFECT_ACCURACY, EFFECT_INFLUENCE


@pytest.fixture
def influence(tmp_path):
    rows = [
        ("any", "shading", 8, 0.08, 0.08, 0.06),
        ("any", "cast_shadows", 8, 0.0, 0.4, 0.003),
        ("ideal", "adaptive_size", 500, 0.1, 0.2, 0.25),
        ("ideal", "noise", 500, 0.0, 0.3, 0.0),
        ("worn_fsr", "noise", 500, 0.3, 0.3, 0.0125),
    ]
    names = [column.name for column in EFFECT_INFLUENCE.columns]
    columns = {name: [row[place] for row in rows] for place, name in enumerate(names)}
    path = tmp_path / "effect_influence.parquet"
    write_table(EFFECT_INFLUENCE, build_table(EFFECT_INFLUENCE, columns), path)
    return path


@pytest.fixture
def accuracy(tmp_path):
    rows = [
        ("ideal", "nothing", 0.6, 0.5, 0.7),
        ("ideal", "adaptive_size", 0.55, 0.4, 0.7),
        ("worn_fsr", "nothing", 0.5, 0.4, 0.6),
        ("worn_fsr", "noise", 0.52, 0.4, 0.6),
    ]
    names = ("scene", "without", "accuracy", "low", "high")
    columns = {name: [row[place] for row in rows] for place, name in enumerate(names)}
    columns |= {"strategy": "fixation", "pipeline": "paper", "classifier": "support_vector_machine"}
    path = tmp_path / "effect_accuracy.parquet"
    write_table(EFFECT_ACCURACY, build_table(EFFECT_ACCURACY, columns), path)
    return path


def test_seconds_are_those_of_the_run_and_shifts_those_of_every_scene(influence):
    figures = influence_figures(influence, "ideal")
    assert (figures.touches, figures.views) == (500, 8)
    assert figures.seconds == pytest.approx(0.1)
    assert figures.seconds_always == pytest.approx(0.5)
    size, noise = figures.touch
    assert (size.milliseconds, size.milliseconds_always) == pytest.approx((200.0, 400.0))
    assert noise.shifts == {"worn_fsr": 0.0125}
    assert figures.view[1].milliseconds_always == pytest.approx(50.0)


def test_leaving_an_effect_out_is_told_as_a_change(accuracy):
    (rows,) = accuracy_rows(accuracy).values()
    assert [row.without for row in rows] == ["nothing", "adaptive_size", "noise"]
    assert rows[1].change == {"ideal": pytest.approx(-0.05)}
    assert rows[2].change == {"worn_fsr": pytest.approx(0.02)}


def test_what_was_not_measured_has_no_figures(tmp_path):
    assert influence_figures(None, "ideal") is None
    assert influence_figures(tmp_path / "none.parquet", "ideal") is None
    assert accuracy_rows(tmp_path / "none.parquet") == {}


def test_every_hard_place_has_a_picture_a_size_and_a_state():
    places = hard_places(PARAMETERS)
    assert [place.name for place in places] == [probe.name for probe in hard_probes()]
    assert all(place.imprint.startswith("data:image/webp;base64,") for place in places)
    assert len({place.imprint for place in places}) > len(places) // 2
    assert {place.state for place in places} <= set(CONTACT_STATES)
    sensor = PARAMETERS.sensor
    assert all(sensor.smallest_size <= place.size <= sensor.largest_size for place in places)


@pytest.mark.slow
def test_the_page_shows_hard_places_and_the_figures_that_are_there(tmp_path, influence, accuracy):
    files = write_run(tmp_path)
    bare = read_page(render_page(read_run(files, PARAMETERS, OBJECTS)))
    assert "cone, tip" in bare.text
    assert "Left out" not in bare.text
    assert "ms always" not in bare.text
    extras = {"effect_influence": influence, "effect_accuracy": accuracy}
    measured = RunFiles(**{**vars(files), "extras": extras})
    page = read_page(render_page(read_run(measured, PARAMETERS, OBJECTS)))
    assert page.mismatches == []
    text = page.text.replace("\xa0", " ")
    assert "500 touches took 0.10 s of effects as this run simulates them, and 0.50 s" in text
    assert "adaptive size 200.0 400.0 25.0 % \u2013 \u2013" in text
    assert "cast shadows 0.00 50.00 0.3 %" in text
    assert "nothing 60.0 % 50.0 % to 70.0 % \u2013 50.0 % 40.0 % to 60.0 %" in text
    assert "noise \u2013 \u2013 +2.0" in text
