"""The page tells what effects cost and change where it was measured, and shows hard places always."""

from report.synthetic import PARAMETERS, write_study

from visuohaptic.report.effects import (
    effect_rows,
    hard_places,
    influence_figures,
    rows_of_scenes,
)
from visuohaptic.report.studies import read_study
from visuohaptic.sensor import hard_probes
from visuohaptic.tables.phases import CONTACT_STATES
from visuohaptic.tables.schema import build_table, write_table
from visuohaptic.tables.studies import EFFECT_INFLUENCE


def write_influence(path):
    """Write what effects cost and move in two scenes."""
    rows = [
        ("any", "shading", 8, 8, 0.08, 0.08, 0.06, True),
        ("any", "cast_shadows", 8, 0, 0.0, 0.4, 0.003, True),
        ("any", "texture", 8, 0, 0.0, 0.0, 0.0, True),
        ("ideal", "adaptive_size", 500, 400, 0.1, 0.2, 0.25, True),
        ("ideal", "noise", 500, 0, 0.0, 0.3, 0.0, True),
        ("worn_fsr", "noise", 500, 500, 0.3, 0.3, 0.0125, True),
    ]
    names = [column.name for column in EFFECT_INFLUENCE.columns]
    columns = {name: [row[place] for row in rows] for place, name in enumerate(names)}
    write_table(EFFECT_INFLUENCE, build_table(EFFECT_INFLUENCE, columns), path)
    return path


def test_every_hard_place_has_a_picture_a_size_and_a_state():
    places = hard_places(PARAMETERS)
    assert [place["name"] for place in places] == [probe.name for probe in hard_probes()]
    assert all(place["imprint"].startswith("data:image/webp;base64,") for place in places)
    assert len({place["imprint"] for place in places}) > len(places) // 2
    assert {place["state"] for place in places} <= set(CONTACT_STATES)
    sensor = PARAMETERS.sensor
    assert all(sensor.smallest_size <= place["size"] <= sensor.largest_size for place in places)


def test_scenes_as_a_whole_have_rows_of_their_own(tmp_path):
    rows = [
        ("ideal", 0.9, "ideal", None),
        ("ideal without adaptive_size", 0.8, "ideal", -0.1),
        ("worn_fsr", 0.7, "worn_fsr", None),
    ]
    study = read_study(write_study(tmp_path, "effects", rows), "effects")
    ((table, found),) = rows_of_scenes(study)
    assert table is study["tables"][0]
    assert [row["condition"] for row in found] == ["ideal", "worn_fsr"]
    failed = read_study(write_study(tmp_path, "effects", [("fsr400", None, None, None)]), "effects")
    assert rows_of_scenes(failed) == []


def test_an_effect_has_its_count_its_time_and_its_shift_in_the_scene_of_the_run(tmp_path):
    influence = influence_figures(write_influence(tmp_path / "influence.parquet"), "worn_fsr")
    summed = [
        {"effect": name, "touches_sum": 1, "runs_sum": 1} for name in ("shading", "noise", "mine")
    ]
    shading, noise, mine = effect_rows(summed, influence, "worn_fsr")
    assert (shading["of"], noise["of"]) == ("1 view", "1 touch")
    assert shading["milliseconds"] == 10
    assert shading["shift"] == 0.06
    assert (noise["milliseconds"], noise["shift"]) == (600, 0.0125)
    assert (mine["milliseconds"], mine["milliseconds_always"], mine["shift"]) == (None, None, None)
    assert [row["shift"] for row in effect_rows(summed, None, "ideal")] == [None, None, None]
