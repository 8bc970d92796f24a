"""What must not matter: the unit, the place and the description of a mesh."""

from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np
import trimesh
from numerics.hard_cases.attention import drive_at_first, look, recovery
from numerics.surfaces import (
    branching_shapes,
    far_off,
    lopsided,
    moved,
    of_trimesh,
    pick,
    points_on_faces,
)

from visuohaptic.attention.parameters import AttentionParameters
from visuohaptic.features.describing import describe_imprints
from visuohaptic.features.parameters import FeatureParameters
from visuohaptic.fixations.parameters import ViewpointParameters
from visuohaptic.fixations.rendering import Views
from visuohaptic.fixations.viewpoints import place_cameras
from visuohaptic.geometry.curvature import measure_shape
from visuohaptic.geometry.raycasting import RayCaster
from visuohaptic.geometry.surface import Surface, read_surface
from visuohaptic.meshes.preparing import MERGE_TOLERANCE, normalise
from visuohaptic.scene.parameters import Scene
from visuohaptic.sensor.parameters import SensorParameters
from visuohaptic.sensor.sensing import touch
from visuohaptic.stability.findings import Finding

RESOLUTION = 128
PAPER = Path(__file__).parents[3] / "meshes" / "paper"


@dataclass(frozen=True)
class Sensed:
    """What is seen and felt of a surface from some viewpoints; saliency maps have the shape (v, rows, columns)."""

    triangles: np.ndarray
    views: Views
    attended: list
    saliency: np.ndarray
    points: np.ndarray
    images: np.ndarray
    features: np.ndarray

    @property
    def lengths(self):
        """Number of distinct fixations of each view."""
        return [found.scanpath.distinct for found in self.attended]


def sense(surface, merge_tolerance=0):
    """Go from a raw surface to what is sensed of it from four viewpoints."""
    made = normalise(surface, "object", merge_tolerance=merge_tolerance).surface
    views, attended = look(made, place_cameras(ViewpointParameters(count=4)), RESOLUTION)
    saliency = np.stack([found.saliency for found in attended])
    points, normals, faces = (
        np.concatenate([getattr(found.scanpath, name) for found in attended])
        for name in ("points", "normals", "faces")
    )
    felt = touch(RayCaster(made), points, normals, SensorParameters(), Scene(), faces=faces)
    deviations = describe_imprints(felt.images, FeatureParameters())
    features = np.column_stack([deviations, points, felt.normals])
    return Sensed(made.triangles, views, attended, saliency, points, felt.images, features)


@cache
def bases():
    """Return the objects that are described in other ways, by name."""
    return {
        "lopsided": lopsided(),
        "box": of_trimesh(trimesh.creation.box((1.0, 0.7, 0.4))),
        "cone": of_trimesh(trimesh.creation.cone(0.6, 1.2, sections=64)),
        "torus": of_trimesh(trimesh.creation.torus(0.6, 0.25)),
    }


@cache
def sense_base(name):
    """Return what is sensed of one of the `bases` as it is."""
    return sense(bases()[name])


@cache
def branching():
    """Return surfaces with edges of more than two faces, by name: drawn ones, and a car of the paper's set."""
    car = read_surface(PAPER / "car" / "kl_VW-new-beetle.ply.gz")
    return {**branching_shapes(), "kl_VW-new-beetle": car}


@cache
def sense_branching(name):
    """Return the sensed values of an unchanged surface of `branching`."""
    return sense(branching()[name], MERGE_TOLERANCE)


KINDS = (
    "vertices in another order",
    "faces in another order",
    "faces wound at random",
    "corners in another order",
    "vertices doubled",
)


def describe(kind, surface, generator):
    """Describe the same surface in another way, one of KINDS."""
    vertices, faces, colours = surface.vertices, surface.faces, surface.face_colours
    if kind == "vertices in another order":
        order = generator.permutation(len(vertices))
        vertices, faces = vertices[order], np.argsort(order)[faces]
    elif kind == "faces in another order":
        order = generator.permutation(len(faces))
        faces, colours = faces[order], colours[order]
    elif kind == "faces wound at random":
        faces = np.where(generator.random((len(faces), 1)) < 0.5, faces[:, ::-1], faces)
    elif kind == "corners in another order":
        shift = generator.integers(0, 3, (len(faces), 1))
        faces = np.take_along_axis(faces, (np.arange(3) + shift) % 3, axis=1)
    else:
        vertices = surface.triangles.reshape(-1, 3)
        faces = np.arange(len(vertices)).reshape(-1, 3)
    return Surface(vertices, faces, colours)


def drive_of(points, attended, mask, upto):
    """Return what drives the eye after some fixations, in float64, by the model's definition."""
    _, drive = drive_at_first(attended.saliency, mask)
    parameters = AttentionParameters()
    for point in attended.scanpath.points[:upto]:
        distance = np.linalg.norm(points - point, axis=-1) / parameters.focus_radius
        drive = np.where(distance <= 1, -1.0, drive * recovery(distance, parameters))
    return np.where(mask, drive, -1.0)


def compare(found, wanted, label, kind=""):
    """Want the same sensations; where peaks tie, another one of them may be fixated.

    `kind` begins the names of the requirements of maps and fixations.
    """
    same_shape = found.lengths == wanted.lengths
    both = found.views.mask & wanted.views.mask
    apart = np.where(both, np.abs(found.saliency - wanted.saliency), 0).max(axis=(1, 2))
    errors = apart if same_shape else np.full(len(both), np.inf)
    yield Finding(f"invariance/{kind}saliency map", errors, label)
    if not same_shape:
        return
    felt = []
    touches = np.split(np.arange(len(wanted.points)), np.cumsum(wanted.lengths)[:-1])
    for view, rows in enumerate(touches):
        apart = np.linalg.norm(found.points[rows] - wanted.points[rows], axis=1)
        same = int(np.append(apart > 1e-3, True).argmax())
        felt += rows[:same].tolist()
        here = f"{label}, view {view}"
        yield Finding(f"invariance/{kind}fixated points", apart[:same], here)
        if same < len(rows):
            # Peaks that tie may change places; then the place chosen is as salient as the best.
            name = "invariance/tied peaks: fixations are those of a map within its error"
            deficit = _deficit(wanted, found, view, same)
            yield Finding(name, deficit, f"{here}, fixation {same + 1}")
    images, features = np.abs(found.images - wanted.images), found.features - wanted.features
    yield from compare_touches(images[felt], features[felt], label, felt)


def compare_touches(images, features, label, touches=None):
    """Want the differences of imprints, shape (n, r, r), in their mean, and those of features to be small."""

    def describe(row):
        return f"{label}, touch {row if touches is None else touches[row]}"

    yield Finding("invariance/images", images.mean(axis=(1, 2)), describe)
    yield Finding("invariance/features", np.abs(features).max(axis=1), describe)


def _deficit(wanted, found, view, step):
    """How much less the eye is driven to where it went than to the best place."""
    best, went = (each.attended[view].scanpath for each in (wanted, found))
    drive = drive_of(wanted.views.point[view], wanted.attended[view], wanted.views.mask[view], step)
    there = drive[went.rows[step], went.columns[step]]
    return max(float(drive[best.rows[step], best.columns[step]] - there), 0.0)


def compare_vertices(found, wanted, name, label):
    """Want triangles in one order at the same places; their corners may be in any order."""
    apart = np.linalg.norm(np.sort(found, axis=1) - np.sort(wanted, axis=1), axis=2)
    return Finding(f"invariance/{name}", apart.max(), label)


def mesh_descriptions(generator, base="lopsided"):
    """Describe one of the `bases` in another way."""
    kind = str(generator.choice(KINDS))
    found = sense(describe(kind, bases()[base], generator))
    wanted = sense_base(base)
    label = f"{base}: {kind}"
    if kind != "faces in another order":
        requirement = "order, winding, corners, doubled vertices: vertices"
        yield compare_vertices(found.triangles, wanted.triangles, requirement, label)
    yield from compare(found, wanted, label)


def branching_edges(generator):
    """Describe a surface with edges of more than two faces in another way."""
    name, kind = (str(generator.choice(each)) for each in (list(branching()), KINDS))
    requirement, label = "edges of more than two faces: ", f"{name}: {kind}"
    surface = normalise(branching()[name], name).surface
    other = describe(kind, surface, generator)
    weights = generator.dirichlet([1.0, 1.0, 1.0], size=len(surface.faces))
    one, two = (
        measure_shape(each).curvature(*points_on_faces(each, weights)) for each in (surface, other)
    )
    yield Finding(f"invariance/{requirement}curvature", np.abs(one - two).max(), label)
    found = sense(describe(kind, branching()[name], generator), MERGE_TOLERANCE)
    yield from compare(found, sense_branching(name), label, requirement)


def mesh_units(generator):
    """Scale a mesh, by any number and by a power of two."""
    wanted = sense_base("lopsided")
    exponent = pick(generator, -6, 6)
    found = sense(moved(lopsided(), 10.0**exponent))
    label = f"size 1e{exponent:.2f}"
    yield compare_vertices(found.triangles, wanted.triangles, "vertices, any scale", label)
    yield from compare(found, wanted, label)
    power = int(generator.integers(-20, 21))
    found = sense(moved(lopsided(), 2.0**power))
    wrong = [
        not np.array_equal(getattr(found, name), getattr(wanted, name))
        for name in ("triangles", "saliency", "points", "images", "features")
    ]
    yield Finding("invariance/scale by a power of two", any(wrong), f"scale 2^{power}")


def mesh_places(generator):
    """Move a mesh far from the origin."""
    away, size, offset = far_off(generator, lopsided())
    found, wanted = (
        normalise(each, "object", merge_tolerance=0).surface.triangles
        for each in (away, lopsided())
    )
    error = np.linalg.norm(found - wanted, axis=2).max()
    label = f"size 1e{size:.1f}, 1e{offset:.2f} sizes off"
    yield Finding("invariance/vertices, offset up to 1e6 sizes", error, label)
