"""The strategies of the plug-in look where their names say."""

import runpy
from pathlib import Path

import numpy as np
import pyarrow.compute as pc
import pytest

import visuohaptic as vh
from visuohaptic.attention.parameters import read_fitted_weights
from visuohaptic.fixations.probing import PLANNED

PLUG_IN = Path(__file__).parents[3] / "studies/first_touch/plug_in/looking.py"


@pytest.fixture(scope="module")
def parts():
    """The parts of the gaze model, with all strategies of the plug-in registered."""
    with pytest.MonkeyPatch.context() as patch:
        for held in ("_entries", "_sources"):
            patch.setattr(PLANNED, held, dict(getattr(PLANNED, held)))
        yield runpy.run_path(str(PLUG_IN))["PARTS"]


def first_place(strategy):
    exploration = vh.example("chair").touch(viewpoints=1, strategy=strategy)
    eye = np.array([*exploration.views.select(["eye_x", "eye_y", "eye_z"]).to_pylist()[0].values()])
    row = exploration.touches.filter(pc.equal(exploration.touches["touch"], 0)).to_pylist()[0]
    return np.array([row["x"], row["y"], row["z"]]), eye


def test_rules_choose_the_place_that_they_name(parts):
    places = {name: first_place(name)[0] for name in ("highest", "nearest", "central", "fixation")}
    _, eye = first_place("fixation")
    axis = eye / np.linalg.norm(eye)
    measures = {
        "highest": lambda place: place[1],
        "nearest": lambda place: -np.linalg.norm(place - eye),
        "central": lambda place: -np.linalg.norm(np.cross(place, axis)),
    }
    for name, measure in measures.items():
        others = [measure(place) for other, place in places.items() if other != name]
        assert measure(places[name]) > max(others)


def test_parts_have_all_weights_of_the_gaze_model_once(parts):
    fitted = read_fitted_weights()
    every = {*fitted["channels"], *fitted["terms"]}
    alone = ("gaze_channels", "gaze_view", "gaze_place", "gaze_shape")
    kept = [name for part in alone for name in parts[part][0]]
    assert sorted(kept) == sorted(every)
    for part in alone:
        without = {*parts[f"gaze_without_{part.removeprefix('gaze_')}"][0]}
        assert without == every - {*parts[part][0]}


def test_all_weights_together_look_as_strategy_human(parts):
    place, _ = first_place("human")
    others = {part: first_place(part)[0] for part in ("gaze_without_channels", "gaze_place")}
    assert all(not np.allclose(place, other) for other in others.values())
