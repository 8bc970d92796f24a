"""What must not matter, on real meshes and for labels; and what must turn or mirror along."""

from pathlib import Path

import numpy as np
import pytest
import trimesh
from attention.scenes import mirrored, turned
from numerics.hard_cases.invariance import (
    KINDS,
    bases,
    compare_imprints,
    describe_otherwise,
    descriptions_of,
    drive_of,
    look,
    sense,
    sense_base,
)
from numerics.recording import worst_of
from numerics.surfaces import float32_exact

from visuohaptic.attention.parameters import AttentionParameters
from visuohaptic.features.describing import describe_imprints
from visuohaptic.features.parameters import FeatureParameters
from visuohaptic.fixations.parameters import ViewpointParameters
from visuohaptic.fixations.places import draw_by_area
from visuohaptic.fixations.viewpoints import place_cameras
from visuohaptic.geometry.raycasting import RayCaster
from visuohaptic.geometry.surface import Surface, read_surface
from visuohaptic.meshes.preparing import normalise
from visuohaptic.recognition.classifiers import fit_classifier
from visuohaptic.recognition.encoding import fit_sequence_encoder
from visuohaptic.recognition.parameters import RecognitionParameters
from visuohaptic.scene.parameters import Scene
from visuohaptic.sensor.parameters import SensorParameters
from visuohaptic.sensor.touching import touch
from visuohaptic.stability import drawings

STEPS = 16
CAMERAS = place_cameras(ViewpointParameters(count=STEPS))
PAPER = Path(__file__).parents[2] / "meshes" / "paper"
REAL = sorted(str(path.relative_to(PAPER)) for path in PAPER.rglob("*.ply.gz"))


@pytest.mark.parametrize(
    "base",
    ["box", *(pytest.param(k, marks=pytest.mark.hard) for k in ("lopsided", "cone", "torus"))],
)
def test_a_finer_tessellation_of_the_same_surface_feels_alike(hold, recorder, base):
    surface = normalise(bases()[base], base, merge_tolerance=0)
    vertices, faces = trimesh.remesh.subdivide(surface.vertices, surface.faces)
    vertices, faces = np.asarray(vertices), np.asarray(faces, dtype=np.int64)
    parts = owners(surface, vertices[faces].mean(axis=1))
    finer = normalise(
        Surface(vertices, faces, surface.face_colours[parts]), base, merge_tolerance=0
    )
    drawn = draw_by_area(surface, 60, np.random.default_rng(1))
    felt = []
    for each, owner in ((surface, drawn.faces), (finer, owners(finer, drawn.points))):
        felt.append(
            touch(
                RayCaster(each),
                drawn.points,
                drawn.normals,
                SensorParameters(),
                Scene(),
                faces=owner,
            )
        )
    label = f"{base}, each triangle cut into four"
    images = [found.images for found in felt]
    recorder.take(map(worst_of, compare_imprints(images[1], images[0], label)))
    deviations = [describe_imprints(each, FeatureParameters()) for each in images]
    hold(
        "invariance/features",
        np.abs(deviations[0] - deviations[1]).max(axis=1),
        lambda row: f"{label}, touch {row}",
        lambda row: drawings.image(images[0][row], "the imprint"),
    )
    # What the eye makes of it is another matter: see `limits` in docs/stability.md.
    (views, coarse), (_, fine) = (look(each, CAMERAS[:: STEPS // 4]) for each in (surface, finer))
    near, change = [], []
    for view, (one, other) in enumerate(zip(coarse, fine, strict=True)):
        change.append(np.abs(one.saliency - other.saliency)[views.mask[view]].max())
        apart = np.linalg.norm(one.scanpath.points[:, None] - other.scanpath.points[None], axis=2)
        near += (apart.min(axis=1) < AttentionParameters().focus_radius).tolist()
    recorder.tell(
        "limits",
        {
            "what": f"fixations on a {base} whose triangles are each cut into four",
            "found": f"saliency map moves by up to {max(change):.2f}; {100 * np.mean(near):.0f} % of fixations have one within a focus",
            "why": "shading and curvature take facets for samples of a smooth surface; cut facets are taken for flat ones",
        },
    )


def owners(surface, points):
    """Find the face on which each point lies: the nearest among those whose sides it is within."""
    corners, normals = surface.triangles, surface.face_normals
    sides = np.roll(corners, -1, axis=1) - corners
    outwards = np.cross(sides, normals[:, None])
    outwards /= np.linalg.norm(outwards, axis=2, keepdims=True)
    found = []
    for point in points:
        offset = point - corners
        beyond = np.maximum(np.einsum("fkd,fkd->fk", offset, outwards).max(axis=1), 0)
        height = np.abs(np.einsum("fd,fd->f", offset[:, 0], normals))
        found.append(int(np.argmin(np.hypot(beyond, height))))
    return np.array(found)


def test_labels_do_not_depend_on_unit_order_or_winding(hold):
    generator = np.random.default_rng(3)
    names = list(bases())
    training = np.concatenate([sequences(sense_base(name)) for name in names])
    labels = np.repeat(np.arange(len(names)), 4)
    parameters = RecognitionParameters()
    encoder = fit_sequence_encoder(training, parameters, np.random.default_rng(0))
    fits = {
        name: fit_classifier(
            name, parameters.classifier, encoder.encode(training), labels, np.random.default_rng(0)
        )[0]
        for name in parameters.classifiers
    }
    for kind in KINDS:
        for place, name in enumerate(names):
            surface = describe_otherwise(bases()[name], generator, kind)
            surface = Surface(
                surface.vertices * 10.0 ** generator.uniform(-6, 6),
                surface.faces,
                surface.face_colours,
            )
            features = encoder.encode(sequences(sense(surface)))
            plain = encoder.encode(training[4 * place : 4 * place + 4])
            for classifier, fitted in fits.items():
                hold(
                    "invariance/labels",
                    fitted.predict(features) != fitted.predict(plain),
                    f"{classifier} on {name}: {kind}",
                )


def sequences(sensed):
    assert set(sensed.lengths) == {5}
    return sensed.features.reshape(4, 5, -1)


@pytest.mark.hard
@pytest.mark.parametrize("base", ["box", "cone", "torus"])
@pytest.mark.parametrize("seed", range(8))
def test_another_description_of_a_symmetric_surface_is_sensed_alike(recorder, base, seed):
    for finding in descriptions_of(base)(np.random.default_rng(seed)):
        recorder.take([worst_of(finding)])


def compare_views(hold, recorder, kind, label, base, other, places, flip):
    """Compare what is attended to in `other` with `base`; `flip` brings its rows onto the base's."""
    views, attended = base
    _, others = other
    moved = 0
    for index, place in enumerate(places):
        mask = views.mask[index]
        saliency = others[place].saliency[:, ::-1] if flip else others[place].saliency
        columns = others[place].scanpath.columns
        columns = mask.shape[1] - 1 - columns if flip else columns
        rows = others[place].scanpath.rows
        both = mask & (saliency > 0)
        hold(
            f"invariance/{kind} object: saliency map",
            np.quantile(np.abs(saliency - attended[index].saliency)[both], 0.999),
            f"{label}, view {index}",
            drawings.image(attended[index].saliency, "the saliency map"),
        )
        path = attended[index].scanpath
        deficit = 0.0
        for step in range(min(len(rows), path.distinct)):
            here = views.point[index][rows[step], columns[step]]
            if np.linalg.norm(here - path.points[step]) > 0.05:
                moved += 1
                drive = drive_of(views.point[index], attended[index], mask, step)
                deficit = (
                    drive[path.rows[step], path.columns[step]] - drive[rows[step], columns[step]]
                )
                break
        hold(
            f"invariance/{kind} object: fixations are those of a map within its error",
            max(deficit, 0.0),
            f"{label}, view {index}",
            drawings.image(attended[index].saliency, "the saliency map"),
        )
    recorder.tell("ties", {"change": kind, "object": label, "views": len(places), "moved": moved})


@pytest.mark.parametrize(
    "path", [REAL[0], *(pytest.param(path, marks=pytest.mark.hard) for path in REAL[1:])]
)
def test_turning_the_object_permutes_its_viewpoints_and_mirroring_mirrors(
    hold, recorder, full, path
):
    surface = normalise(read_surface(PAPER / path), path)
    cameras = CAMERAS if full else CAMERAS[:4]
    label = path.removesuffix(".ply.gz")
    # Both sides are rounded to float32 alike, as every mesh file is.
    base = look(float32_exact(surface), cameras, 256 if full else 128)
    steps = (1, 5) if full else (1,)
    for step in steps:
        circle = [CAMERAS[(camera + step) % STEPS] for camera in range(len(cameras))]
        other = look(
            float32_exact(turned(surface, 360.0 * step / STEPS)), circle, 256 if full else 128
        )
        compare_views(hold, recorder, "turned", label, base, other, range(len(cameras)), flip=False)
    opposite = [CAMERAS[-camera % STEPS] for camera in range(len(cameras))]
    other = look(float32_exact(mirrored(surface)), opposite, 256 if full else 128)
    compare_views(hold, recorder, "mirrored", label, base, other, range(len(cameras)), flip=True)
