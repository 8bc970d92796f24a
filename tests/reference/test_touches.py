"""Phase touches against the reference, which gets the product's surface and probing locations."""

from dataclasses import dataclass, field
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from reference import touches as reference
from reference.touch_scenes import scenes

import visuohaptic as vh

PAPER = Path(__file__).parents[2] / "meshes" / "paper"

# Unit vectors: a cross product, a projection and a division by a length, each of a few roundings of 1e-16.
DIRECTION = 1e-14
# Sizes and heights: coordinates of at most 1 and quotients by the cosine of a ray's angle. Rays of these scenes
# that graze a face at 3° lose a factor of 20, small triangles another.
LENGTH = 1e-12
# Images: float32 rounds by 6e-8; LENGTH divided by the least relief adds 1e-8.
IMAGE = 1e-7
# A height this near to a threshold decides by rounding.
TIE = 1e-9


@dataclass(frozen=True)
class Case:
    """A scene, the rule or the points of its touches, and parameters of the sensor."""

    scene: str
    resolution: int = 8
    strategy: str = "random_anywhere"
    viewpoints: int = 2
    points: tuple = ()
    sensor: dict = field(default_factory=dict, hash=False)

    def __str__(self):
        what = "points" if self.points else self.strategy
        return "-".join([self.scene.replace(" ", "_"), what, str(self.resolution), *self.sensor])


GIVEN = {
    "cube": ((0.575, 0.57735, 0.1), (0.1, 0.57735, -0.56), (0.576, 0.3, 0.575), (0.57735, 0.57, -0.57)),
    "thin plate": ((0.8192, 0.001, 0.1), (0.1, 0.002, 0.5735), (0.81, 0.0033, 0.57)),
    "narrow groove": (
        (0.001, 0.2327, 0.1), (0.0189, 0.3, 0.2), (-0.0189, 0.41, 0.1), (0.03, 0.4212, 0.2),
        (0.012, 0.2327, 0.1),
    ),
    "wide groove": (
        (0.01, 0.2447, 0.1), (0.1, 0.2447, -0.3), (0.131, 0.2447, 0.2), (-0.1389, 0.3, 0.1),
        (0.2, 0.4342, 0.1), (0.1385, 0.2447, 0.23),
    ),
    "spike": (
        (0.0214, 0.0346, 0.0), (0.05, 0.0346, 0.01), (0.024, 0.0346, 0.0), (0.004, 0.26, 0.001), (0.1, 0.0346, -0.07),
        (0.015, 0.1, 0.003), (-0.06, 0.0346, 0.05),
    ),
    "needle": ((0.0005, 0.2, 0.0003), (0.02, 0.0353, 0.01), (0.08, 0.0353, 0.0321), (0.1, 0.0353, 0.0)),
    "two boxes": ((0.05, 0.2, 0.1), (0.0, -0.2, 0.3), (-0.1, 0.28, 0.1)),
    "plate over plate": ((-0.63, -0.1625, 0.1), (-0.6, -0.1625, 0.2), (-0.66, -0.1625, -0.66), (0.1, 0.1625, 0.1)),
    "cup": ((0.2, -0.5, 0.1), (0.55, 0.1, 0.1), (0.57, 0.75, 0.02), (0.604, 0.7698, 0.0), (0.02, -0.5, 0.03)),
    # The first place is below the wire.
    "wire over plate": ((0.01408, 0.07006, 0.1), (0.0155, 0.07006, 0.2), (0.3, 0.07006, 0.2)),
    "narrow cup": ((0.02, -0.76, 0.03), (0.19, 0.3, 0.01), (0.24, 0.9573, 0.001)),
    "steps": ((-0.17, 0.032, 0.1), (-0.3, 0.032, 0.2), (-0.1, 0.0715, 0.3), (0.2, 0.0715, 0.3), (0.1, 0.0835, 0.1)),
    "leaning wall": (
        (-0.1, -0.0219, 0.1), (0.05, -0.0219, 0.33), (0.2, -0.0219, 0.1), (0.13, -0.0219, -0.1),
        (-0.35, -0.0219, 0.1), (-0.39, -0.0219, 0.1), (-0.2, 0.25, 0.2),
    ),
    "blade": ((0.3, 0.1, -0.05), (-0.84, -0.5568, -0.06)),
    "torus": ((0.45, 0.05, 0.1), (0.74, 0.25, 0.05), (-0.3, 0.02, -0.4)),
}  # fmt: skip
EASY = {
    "cube": 1,
    "turned cube": 1,
    "ball": 1,
    "flat relief": 1,
    "thin plate": 1,
    "two boxes": 1,
    "narrow groove": 1,
}
COARSE = {"cube", "two boxes", "plate over plate", "narrow cup", "steps", "blade", "torus"}

CASES = [
    *[Case(name, viewpoints=EASY.get(name, 2)) for name in scenes()],
    *[Case(name, 8 if name in COARSE else 16, points=points) for name, points in GIVEN.items()],
    Case("deep waves", 32, viewpoints=1),
    Case("leaning wall", 32, points=GIVEN["leaning wall"][:2]),
    Case("cup", 16, viewpoints=1, sensor={"normalisation": "absolute", "depth_range": 0.05}),
    Case("steps", sensor={"largest_size": 0.2, "smallest_size": 0.05, "depth_range": 0.03}),
    Case("waves", sensor={"normalisation": "absolute"}),
    Case("fine relief", 15, sensor={"depth_range": 0.0015}),
    Case("deep waves", sensor={"smallest_size": 0.06}),
    # A part within the square is higher than the clearance, where the sensor stops.
    Case("wide groove", points=GIVEN["wide groove"][2:], sensor={"depth_range": 0.3}),
    # The eye's normals are those of rendering; they only choose the side of the touched face.
    Case("torus", strategy="fixation", viewpoints=1),
]
REACH = [
    Case(name, 8, "random", 3)
    for name in ("two boxes", "plate over plate", "close plates", "cup", "narrow cup", "deep waves", "steps",
                 "leaning wall", "wide groove", "torus")
]  # fmt: skip
# Three quarters of the places are within other shells, so sequences pass over 16 places and end early.
REACH += [Case("shells", 8, "random", 13), Case("cup", 8, "fixation", 2)]


@cache
def explored(case):
    """Return the product's exploration, and the reference's sensor with the same parameters."""
    parameters = {"sensor.resolution": case.resolution, "rendering.resolution": 64}
    parameters |= {f"sensor.{name}": value for name, value in case.sensor.items()}
    load = vh.load(scenes()[case.scene])
    if case.points:
        exploration = load.touch(
            at=case.points, parameters={**parameters, "probing.unreachable": "keep"}
        )
    else:
        exploration = load.touch(case.viewpoints, case.strategy, parameters)
    return exploration, reference.Sensor(resolution=case.resolution, **case.sensor)


def mesh_of(exploration):
    surface = exploration.surface
    return np.asarray(surface.vertices, float), np.asarray(surface.faces)


def places_of(exploration):
    """Return place, face and direction of each probing location by viewpoint and index."""
    places = {}
    for row in exploration.fixations.to_pylist():
        place = np.array([row["x"], row["y"], row["z"]])
        towards = np.array([row["normal_x"], row["normal_y"], row["normal_z"]])
        places[row["viewpoint"], row["touch"]] = place, row["face"], towards
    return places


@cache
def touched_again(case):
    """Return each touch of the product beside the touch of the reference at the same location."""
    exploration, sensor = explored(case)
    vertices, faces = mesh_of(exploration)
    places = places_of(exploration)
    pairs = []
    for row in exploration.touches.to_pylist():
        place = places[row["viewpoint"], row["rank"]]
        pairs.append((row, reference.touch(*place, sensor, vertices, faces)))
    return pairs


def compare(row, touch):
    """Check each quantity of one touch."""
    normal = [row["normal_x"], row["normal_y"], row["normal_z"]]
    tangent = [row["tangent_x"], row["tangent_y"], row["tangent_z"]]
    np.testing.assert_allclose(normal, touch.normal, rtol=0, atol=DIRECTION)
    np.testing.assert_allclose(tangent, touch.column_axis, rtol=0, atol=DIRECTION)
    np.testing.assert_allclose(row["sensor_size"], touch.size, rtol=0, atol=LENGTH)
    np.testing.assert_allclose(row["penetration"], touch.penetration, rtol=0, atol=LENGTH)
    np.testing.assert_allclose(row["image"], touch.image.ravel(), rtol=0, atol=IMAGE)
    assert row["contact_state"] == touch.state


@pytest.mark.parametrize("case", CASES, ids=str)
def test_touches_are_those_of_the_reference(case):
    assert touched_again(case)
    for row, touch in touched_again(case):
        compare(row, touch)


@pytest.mark.parametrize("case", REACH, ids=str)
def test_places_in_reach_are_those_of_the_reference(case):
    exploration, sensor = explored(case)
    vertices, faces = mesh_of(exploration)
    places = places_of(exploration)
    for viewpoint in range(case.viewpoints):
        ranks = [rank for view, rank in sorted(places) if view == viewpoint]
        reached = [
            reference.in_reach(*places[viewpoint, rank], sensor, vertices, faces) for rank in ranks
        ]
        rows = exploration.touches.to_pylist()
        touched = [row["rank"] for row in rows if row["viewpoint"] == viewpoint]
        assert touched == reference.touched_places(reached)
        numbers = [row["touch"] for row in rows if row["viewpoint"] == viewpoint]
        assert numbers == list(range(len(touched)))


@pytest.mark.parametrize("scene", ["wire over plate", "leaning wall", "spike"])
def test_given_places_in_reach_are_those_of_the_reference(scene):
    points = GIVEN[scene]
    exploration = vh.load(scenes()[scene]).touch(at=points[:1], parameters={"sensor.resolution": 8})
    sensor = reference.Sensor(resolution=8)
    vertices, faces = mesh_of(exploration)
    acquired = []
    for rank, point in enumerate(points, 1):
        exploration, felt = exploration.touch_next(point)
        place = places_of(exploration)[0, rank]
        assert felt.acquired == reference.in_reach(*place, sensor, vertices, faces)
        acquired.append(felt.acquired)
    assert set(acquired) == {True, False}


@pytest.mark.parametrize(
    "case",
    [case for case in CASES if case.strategy == "random_anywhere" and not case.points],
    ids=str,
)
def test_normals_of_unseen_places_are_those_of_the_reference(case):
    exploration, _ = explored(case)
    vertices, faces = mesh_of(exploration)
    for place, face, towards in places_of(exploration).values():
        normal = reference.outward_normal(place, face, vertices, faces)
        np.testing.assert_allclose(towards, normal, rtol=0, atol=DIRECTION)


def test_scenes_have_every_state_often_and_no_tie():
    states, ties = [], []
    for case in CASES:
        _, sensor = explored(case)
        for row, touch in touched_again(case):
            states.append(touch.state)
            heights = min(touch.penetration, reference.CLEARANCE) - touch.gaps
            thresholds = (reference.TOLERANCE, reference.CLEARANCE, -sensor.depth_range)
            if min(np.abs(heights - threshold).min() for threshold in thresholds) < TIE:
                ties.append((str(case), row["touch"]))
    counts = {state: states.count(state) for state in sorted(set(states))}
    assert sorted(counts) == ["at_minimum", "blocked", "full", "partial", "shrunk"]
    assert min(counts.values()) >= 5, counts
    assert ties == []


@pytest.mark.long
@pytest.mark.parametrize("path", sorted(PAPER.glob("*/*.ply.gz")), ids=lambda path: path.name)
def test_touches_of_the_paper_objects_are_those_of_the_reference(path):
    sensor = reference.Sensor()
    exploration = vh.load(path).touch(1, "random_anywhere")
    vertices, faces = mesh_of(exploration)
    places = places_of(exploration)
    for row in exploration.touches.to_pylist():
        place, face, towards = places[0, row["rank"]]
        touch = reference.touch(place, face, towards, sensor, vertices, faces)
        compare(row, touch)
        reached = reference.in_reach(place, face, towards, sensor, vertices, faces)
        assert not reached or row["contact_state"] not in {"blocked", "at_minimum"}
        normal = reference.outward_normal(place, face, vertices, faces)
        np.testing.assert_allclose(towards, normal, rtol=0, atol=DIRECTION)
