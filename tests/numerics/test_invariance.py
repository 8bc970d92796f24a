"""What must not matter, on real meshes and for labels; and what must turn or mirror along."""

from pathlib import Path

import numpy as np
import pytest
import trimesh
from attention.scenes import mirrored, turned
from numerics.hard_cases.attention import look
from numerics.hard_cases.invariance import (
    KINDS,
    bases,
    compare_touches,
    describe,
    drive_of,
    mesh_descriptions,
    sense,
    sense_base,
)
from numerics.hard_cases.learning import DEFAULT, fit_quietly
from numerics.surfaces import float32_exact, moved

from visuohaptic.features.describing import describe_imprints
from visuohaptic.features.parameters import FeatureParameters
from visuohaptic.fixations.parameters import ViewpointParameters
from visuohaptic.fixations.places import draw_by_area
from visuohaptic.fixations.viewpoints import place_cameras
from visuohaptic.geometry.raycasting import RayCaster
from visuohaptic.geometry.surface import Surface, read_surface
from visuohaptic.meshes.preparing import normalise
from visuohaptic.recognition.encoding import SequenceEncoder
from visuohaptic.scene.parameters import Scene
from visuohaptic.sensor.parameters import SensorParameters
from visuohaptic.sensor.sensing import touch
from visuohaptic.stability.findings import Finding

STEPS = 16
CAMERAS = place_cameras(ViewpointParameters(count=STEPS))
PAPER = Path(__file__).parents[2] / "meshes" / "paper"
REAL = sorted(str(path.relative_to(PAPER)) for path in PAPER.rglob("*.ply.gz"))


def hard(*values):
    return [pytest.param(value, marks=pytest.mark.hard) for value in values]


@pytest.mark.parametrize("base", ["box", *hard("lopsided", "cone", "torus")])
def test_a_finer_tessellation_of_the_same_surface_feels_alike(recorder, base):
    surface = normalise(bases()[base], base, merge_tolerance=0).surface
    vertices, faces = trimesh.remesh.subdivide(surface.vertices, surface.faces)
    # Each triangle is cut into four, one after the other.
    parents = np.repeat(np.arange(len(surface.faces)), 4)
    finer = Surface(vertices, faces.astype(np.int64), surface.face_colours[parents])
    finer = normalise(finer, base, merge_tolerance=0).surface
    drawn = draw_by_area(finer, 60, np.random.default_rng(1))
    pressed = (drawn.points, drawn.normals, SensorParameters(), Scene())
    coarse = touch(RayCaster(surface), *pressed, faces=parents[drawn.faces]).images
    fine = touch(RayCaster(finer), *pressed, faces=drawn.faces).images
    features = [describe_imprints(images, FeatureParameters()) for images in (coarse, fine)]
    label = f"{base}, each triangle cut into four"
    images = np.abs(fine - coarse)
    recorder.take(compare_touches(images, features[0] - features[1], label))


def test_labels_do_not_depend_on_unit_order_or_winding(recorder):
    generator = np.random.default_rng(3)
    training = np.concatenate([sequences(sense_base(name)) for name in bases()])
    labels = np.repeat(np.arange(len(bases())), 4)
    encoder = SequenceEncoder(DEFAULT).fit(training)
    plain = encoder.transform(training)
    fits = {name: fit_quietly(name, plain, labels) for name in DEFAULT.classifiers}
    for kind in KINDS:
        for place, (name, base) in enumerate(bases().items()):
            surface = moved(describe(kind, base, generator), 10.0 ** generator.uniform(-6, 6))
            features = encoder.transform(sequences(sense(surface)))
            for classifier, fitted in fits.items():
                wanted = fitted.predict(plain)[labels == place]
                changed = fitted.predict(features) != wanted
                recorder.hold("invariance/labels", changed, f"{classifier} on {name}: {kind}")


def sequences(sensed):
    assert set(sensed.lengths) == {5}
    return sensed.features.reshape(4, 5, -1)


@pytest.mark.hard
@pytest.mark.parametrize("base", ["box", "cone", "torus"])
@pytest.mark.parametrize("seed", range(8))
def test_another_description_of_a_symmetric_surface_is_sensed_alike(recorder, base, seed):
    recorder.take(mesh_descriptions(np.random.default_rng(seed), base))


def compare_views(kind, label, base, others, *, flip):
    """Want others to be attended to as the base; `flip` brings their columns onto the base's."""
    views, attended = base
    for index, (one, other) in enumerate(zip(attended, others, strict=True)):
        mask, point = views.mask[index], views.point[index]
        saliency, columns = other.saliency, other.scanpath.columns
        if flip:
            saliency, columns = saliency[:, ::-1], mask.shape[1] - 1 - columns
        both = mask & (saliency > 0)
        error = np.quantile(np.abs(saliency - one.saliency)[both], 0.999)
        here = f"{label}, view {index}"
        yield Finding(f"invariance/{kind} object: saliency map", error, here)
        deficit, path = 0.0, one.scanpath
        places = zip(other.scanpath.rows, columns, strict=True)
        for step, (went, wanted) in enumerate(zip(places, path.points, strict=False)):
            if np.linalg.norm(point[went] - wanted) > 0.05:
                drive = drive_of(point, one, mask, step)
                deficit = drive[path.rows[step], path.columns[step]] - drive[went]
                break
        name = f"invariance/{kind} object: fixations are those of a map within its error"
        yield Finding(name, max(deficit, 0.0), here)


@pytest.mark.parametrize("path", [REAL[0], *hard(*REAL[1:])])
def test_turning_the_object_permutes_its_viewpoints_and_mirroring_mirrors(recorder, full, path):
    surface = normalise(read_surface(PAPER / path), path).surface
    cameras, resolution = (CAMERAS, 256) if full else (CAMERAS[:4], 128)
    label, found = path.removesuffix(".ply.gz"), []
    # Both sides are rounded to float32 alike, as every mesh file is.
    base = look(float32_exact(surface), cameras, resolution)
    for step in (1, 5) if full else (1,):
        circle = [CAMERAS[(camera + step) % STEPS] for camera in range(len(cameras))]
        other = float32_exact(turned(surface, 360.0 * step / STEPS))
        _, others = look(other, circle, resolution)
        found += compare_views("turned", label, base, others, flip=False)
    opposite = [CAMERAS[-camera % STEPS] for camera in range(len(cameras))]
    _, others = look(float32_exact(mirrored(surface)), opposite, resolution)
    found += compare_views("mirrored", label, base, others, flip=True)
    recorder.take(found)
