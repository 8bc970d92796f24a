"""Views in which nothing stands out, or hardly anything is seen, and the model's parts by other means."""

import numpy as np
import pytest
import scipy.ndimage
import trimesh
from attention.scenes import lopsided, surface_of
from hypothesis import assume, given
from hypothesis import strategies as st
from numerics import drawings

from visuohaptic.attention.model import attend
from visuohaptic.attention.parameters import AttentionParameters
from visuohaptic.attention.pyramid import GOES_ON, NOTHING_BEYOND, blur, enlarge, reduce
from visuohaptic.attention.scanpath import INWARD, TIE, scan
from visuohaptic.fixations.parameters import RenderingParameters
from visuohaptic.fixations.rendering import render_views
from visuohaptic.fixations.viewpoints import Camera
from visuohaptic.geometry.curvature import measure_shape
from visuohaptic.geometry.raycasting import RayCaster

SEEDS = st.integers(0, 2**32 - 1)
SIZE = 64


def flat_view(colour, mask, curvature=None):
    """Give the arrays of `attend` for a flat panel of width 2, seen head on."""
    rows, columns = mask.shape
    y, x = np.mgrid[:rows, :columns]
    point = np.stack([2 * x / columns - 1, 1 - 2 * y / columns, np.zeros_like(x)], axis=-1)
    seen = mask[..., None]
    return {
        "colour": np.where(seen, colour, 0.85).astype(np.float32)[None],
        "mask": mask[None],
        "point": np.where(seen, point, 0.0)[None],
        "normal": np.where(seen, [0.0, 0.0, 1.0], 0.0)[None],
        "face": np.where(mask, 0, -1)[None],
        "curvature": (np.zeros(mask.shape) if curvature is None else curvature).astype(np.float32)[
            None
        ],
    }


def check(hold, view, found, label, parameters):
    mask, picture = view["mask"][0], drawings.image(found.saliency, label)
    maps = np.stack([found.saliency, *found.conspicuity.values()])
    wrong = not np.isfinite(maps).all() or maps.min() < 0 or (maps[:, ~mask] != 0).any()
    wrong |= found.saliency.max() > 1 or (0 < found.saliency.max() < 1)
    hold("attention/maps are finite, within 0 and 1, zero beside the object", wrong, label, picture)
    path = found.scanpath
    apart = np.linalg.norm(path.points[:, None] - path.points[None], axis=2)
    apart[np.diag_indices(len(apart))] = np.inf
    wrong = (apart < parameters.focus_radius * (1 - 1e-6)).any() or not mask[
        path.rows, path.columns
    ].all()
    wrong |= mask.any() and path.distinct == 0
    hold(
        "attention/fixations: distinct, on the object, a focus apart",
        wrong,
        label,
        picture,
        cases=max(path.distinct, 1),
    )


def hard_masks(generator):
    full = np.ones((SIZE, SIZE), dtype=bool)
    none = np.zeros_like(full)
    pixel = none.copy()
    pixel[5, 60] = True
    corner = none.copy()
    corner[0, 0] = True
    line = none.copy()
    line[31] = True
    ring = np.hypot(*(np.indices(full.shape) - 31.5)) < 30
    ring &= np.hypot(*(np.indices(full.shape) - 31.5)) > 28
    return {
        "all": full, "nothing": none, "one pixel": pixel, "the corner pixel": corner, "a line": line,
        "a ring": ring, "a checkerboard": np.indices(full.shape).sum(axis=0) % 2 == 0,
        "scattered pixels": generator.random(full.shape) < 0.003,
    }  # fmt: skip


def hard_colours(generator):
    peak = np.full((SIZE, SIZE, 3), 0.5)
    peak[30, 30] = 1.0
    plateau = np.full((SIZE, SIZE, 3), 0.2)
    plateau[8:28, 8:28] = plateau[36:56, 36:56] = 0.8
    return {
        "all equal": np.full((SIZE, SIZE, 3), 0.5), "black": np.zeros((SIZE, SIZE, 3)),
        "equal but for 1 ulp": np.where(generator.random((SIZE, SIZE, 3)) < 0.5, 0.5, np.nextafter(np.float32(0.5), 1)),
        "a single peak": peak, "two equal plateaus": plateau, "noise": generator.random((SIZE, SIZE, 3)),
        "as dark as float32 goes": np.full((SIZE, SIZE, 3), 1e-45), "1e30": 1e30 * generator.random((SIZE, SIZE, 3)),
        "1e-30": 1e-30 * generator.random((SIZE, SIZE, 3)),
    }  # fmt: skip


@pytest.mark.parametrize("seen", hard_masks(np.random.default_rng(0)))
@pytest.mark.parametrize("painted", hard_colours(np.random.default_rng(0)))
@pytest.mark.parametrize(
    "normalisation", ["local_maxima", pytest.param("iterative", marks=pytest.mark.hard)]
)
def test_a_hard_view_ends_in_finite_maps_and_distinct_fixations(hold, seen, painted, normalisation):
    generator = np.random.default_rng(1)
    parameters = AttentionParameters(normalisation=normalisation)
    bend = generator.choice([0.0, 1.0, 1e30], (SIZE, SIZE))
    view = flat_view(hard_colours(generator)[painted], hard_masks(generator)[seen], bend)
    found = attend(**view, parameters=parameters)[0]
    check(hold, view, found, f"{painted}, seen: {seen}", parameters)


@given(seed=SEEDS, share=st.floats(0, 1), exponent=st.floats(-30, 30))
def test_any_view_ends_in_finite_maps_and_distinct_fixations(hold, seed, share, exponent):
    generator = np.random.default_rng(seed)
    colour = generator.random((SIZE, SIZE, 3)) * 10.0**exponent
    smooth = scipy.ndimage.gaussian_filter(generator.normal(size=(SIZE, SIZE)), 4)
    mask = smooth >= np.quantile(smooth, share)
    parameters = AttentionParameters(inhibition_falloff=float(seed % 2))
    view = flat_view(colour, mask, 10.0 ** generator.uniform(-3, 3, mask.shape))
    found = attend(**view, parameters=parameters)[0]
    check(hold, view, found, f"noise of 1e{exponent:.0f} on {mask.sum()} pixels", parameters)


@pytest.mark.parametrize("distance", [0.0, 1e-6, 0.3, 0.55, 0.9])
def test_a_camera_inside_the_object_sees_finite_things(hold, distance):
    inside = surface_of(trimesh.creation.icosphere(3))
    for surface in (inside, lopsided()):
        cameras = [Camera(azimuth, 20.0, distance, 40.0) for azimuth in (0.0, 135.0)]
        views = render_views(RayCaster(surface), cameras, RenderingParameters(resolution=SIZE))
        arrays = {
            name: getattr(views, name)
            for name in ("colour", "mask", "point", "normal", "face", "curvature")
        }
        parameters = AttentionParameters()
        for row, found in enumerate(attend(**arrays, parameters=parameters)):
            view = {name: values[row : row + 1] for name, values in arrays.items()}
            check(hold, view, found, f"camera at {distance:g} from the centre", parameters)


@given(seed=SEEDS, power=st.integers(-60, 60))
def test_brightness_by_a_power_of_two_moves_no_bit(hold, seed, power):
    generator = np.random.default_rng(seed)
    mask = np.ones((SIZE, SIZE), dtype=bool)
    colour = generator.random((SIZE, SIZE, 3)).astype(np.float32)
    plain, scaled = (
        attend(**flat_view(values, mask), parameters=AttentionParameters())[0]
        for values in (colour, np.ldexp(colour, power))
    )
    hold(
        "attention/brightness by a power of two",
        (plain.saliency != scaled.saliency).any()
        or (plain.scanpath.rows != scaled.scanpath.rows).any(),
        f"noise (seed {seed}) times 2^{power}",
    )


def way_of_the_eye(saliency, mask, places, parameters):
    """Follow the eye by its definition, in float64; stop where two places nearly tie."""
    depth = scipy.ndimage.distance_transform_edt(np.pad(mask, 1))[1:-1, 1:-1]
    drive = saliency + INWARD * depth / depth.max()
    allowed = mask & (depth > 3)
    way = []
    for _ in range(parameters.fixations):
        value = np.where(allowed, drive, -1.0)
        best = np.unravel_index(np.argmax(value), value.shape)
        distance = np.linalg.norm(places - places[best], axis=-1)
        rival = value.copy()
        rival[best] = -1.0
        if value[best] - rival.max() < 2 * TIE + INWARD * 0.05:
            break
        way.append((int(best[0]), int(best[1])))
        progress = np.clip((distance - 1) / parameters.inhibition_falloff, 0, 1)
        drive = drive * progress**2 * (3 - 2 * progress)
        allowed &= distance > 1
    return way


@given(seed=SEEDS, inhibition=st.sampled_from(["surface", "image"]))
def test_the_way_of_the_eye_is_that_of_its_definition(hold, seed, inhibition):
    generator = np.random.default_rng(seed)
    mask = np.hypot(*(np.indices((SIZE, SIZE)) - 31.5)) < 31
    # Levels three ties apart, on pixels well inside.
    pixels = np.flatnonzero(scipy.ndimage.binary_erosion(mask, iterations=5).ravel())
    chosen = generator.choice(pixels, 1200, replace=False)
    saliency = np.zeros(SIZE * SIZE)
    saliency[chosen] = 0.4 + np.arange(1200) * 5 * TIE
    saliency = saliency.reshape(SIZE, SIZE)
    view = flat_view(np.zeros((SIZE, SIZE, 3)), mask)
    parameters = AttentionParameters(inhibition=inhibition)
    point = view["point"][0]
    places = (
        point / parameters.focus_radius
        if inhibition == "surface"
        else np.stack(np.indices(mask.shape), axis=-1) / (parameters.focus_fraction * SIZE)
    )
    wanted = way_of_the_eye(saliency, mask, places, parameters)
    assume(wanted)
    path = scan(
        saliency.astype(np.float32), mask, point, view["normal"][0], view["face"][0], parameters
    )
    found = list(zip(path.rows.tolist(), path.columns.tolist(), strict=True))[: len(wanted)]
    hold(
        "attention/way of the eye against its definition in float64",
        [a != b for a, b in zip(found, wanted, strict=True)],
        lambda row: (
            f"fixation {row + 1} on random levels (seed {seed}), inhibition on the {inhibition}"
        ),
        drawings.image(saliency, "a saliency map of random levels"),
    )


@given(
    seed=SEEDS,
    power=st.sampled_from([2, 3, 4, 5, 6, 7]),
    border=st.sampled_from([GOES_ON, NOTHING_BEYOND]),
)
def test_the_pyramid_is_that_of_scipy(hold, seed, power, border):
    plane = np.random.default_rng(seed).random((2**power, 2**power)).astype(np.float32)
    exact = plane.astype(np.float64)
    mode = "nearest" if border == GOES_ON else "constant"
    for axis in (0, 1):
        exact = scipy.ndimage.correlate1d(exact, [0.25, 0.5, 0.25], axis=axis, mode=mode)
    half = exact.reshape(2 ** (power - 1), 2, 2 ** (power - 1), 2).mean(axis=(1, 3))
    steps = np.clip((np.arange(2 ** (power + 1)) + 0.5) / 2 - 0.5, 0, 2**power - 1)
    larger = scipy.ndimage.map_coordinates(
        plane.astype(np.float64), np.meshgrid(steps, steps, indexing="ij"), order=1, mode="nearest"
    )
    label = f"noise of {2**power}² pixels (seed {seed})"
    name = "attention/pyramid against scipy.ndimage"
    hold(name, np.abs(blur(plane, border) - exact), label)
    hold(name, np.abs(reduce(plane, border) - half), label)
    hold(name, np.abs(enlarge(plane, 2 ** (power + 1)) - larger), label)


@pytest.mark.parametrize("radius", [1e-3, 0.5, 1.0])
def test_a_uniform_sphere_is_curved_alike_everywhere(hold, radius):
    surface = surface_of(trimesh.creation.icosphere(4, radius=radius))
    # The reach of an edge's curvature and the largest curvedness scale with the surface.
    shape = measure_shape(surface, 40.0, 0.03 * radius)
    hold(
        "attention/a uniform sphere's curvature",
        np.abs(shape.corner_curvature * radius - 1).ravel(),
        f"a sphere of radius {radius:g}",
    )
