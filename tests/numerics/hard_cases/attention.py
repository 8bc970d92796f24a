"""Views in which nothing stands out or hardly anything is seen, and the model's parts by other means."""

import numpy as np
import trimesh
from numerics.surfaces import ball, lopsided, of_trimesh, pick
from scipy import ndimage

from visuohaptic.attention.model import attend
from visuohaptic.attention.parameters import AttentionParameters
from visuohaptic.attention.pyramid import BORDER_REPEATED, BORDER_ZERO, blur, enlarge, reduce
from visuohaptic.attention.scanpath import INWARD_WEIGHT, TIE_TOLERANCE, scan
from visuohaptic.fixations.parameters import RenderingParameters
from visuohaptic.fixations.rendering import render_views
from visuohaptic.fixations.viewpoints import Camera
from visuohaptic.geometry.curvature import CREASE_WIDTH, measure_shape
from visuohaptic.geometry.raycasting import RayCaster
from visuohaptic.stability.findings import Finding

SIZE = 64


def flat_view(colour, mask, curvature=None):
    """Return the arrays of `attend` for a flat panel of width 2, seen head on."""
    rows, columns = mask.shape
    y, x = np.mgrid[:rows, :columns]
    point = np.stack([2 * x / columns - 1, 1 - 2 * y / columns, np.zeros_like(x)], axis=-1)
    seen = mask[..., None]
    bend = np.zeros(mask.shape) if curvature is None else curvature
    return {
        "colour": np.where(seen, colour, 0.85).astype(np.float32)[None],
        "mask": mask[None],
        "point": np.where(seen, point, 0.0)[None],
        "normal": np.where(seen, [0.0, 0.0, 1.0], 0.0)[None],
        "face": np.where(mask, 0, -1)[None],
        "curvature": bend.astype(np.float32)[None],
    }


def look(surface, cameras, resolution):
    """Render views of a surface, and attend to them."""
    views = render_views(RayCaster(surface), cameras, RenderingParameters(resolution=resolution))
    return views, list(attend(**views.attend_arguments(), parameters=AttentionParameters()))


def judge(found, mask, label, parameters):
    """Want maps within 0 and 1, and fixations on the object, a focus apart."""
    maps = np.stack([found.saliency, *found.conspicuity.values()])
    wrong = not np.isfinite(maps).all() or maps.min() < 0 or bool((maps[:, ~mask] != 0).any())
    wrong |= found.saliency.max() > 1 or (0 < found.saliency.max() < 1)
    name = "attention/maps are finite, within 0 and 1, zero beside the object"
    yield Finding(name, wrong, label)
    path = found.scanpath
    apart = np.linalg.norm(path.points[:, None] - path.points[None], axis=2)
    apart[np.diag_indices(len(apart))] = np.inf
    wrong = (apart < parameters.focus_radius * (1 - 1e-6)).any(axis=1)
    wrong |= ~mask[path.rows, path.columns]
    name = "attention/fixations: distinct, on the object, a focus apart"
    yield Finding(name, wrong if path.distinct else mask.any(), label)


def hard_masks(generator):
    """Return silhouettes that leave little to look at, shape (SIZE, SIZE), by name."""
    row, column = np.indices((SIZE, SIZE))
    aside = np.hypot(row - 31.5, column - 31.5)
    return {
        "all": row >= 0, "nothing": row < 0, "one pixel": (row == 5) & (column == 60),
        "the corner pixel": row + column == 0, "a line": row == 31, "a ring": (aside < 30) & (aside > 28),
        "a checkerboard": (row + column) % 2 == 0,
        "scattered pixels": generator.random((SIZE, SIZE)) < 0.003,
    }  # fmt: skip


def hard_colours(generator):
    """Return colours in which nothing stands out, or that hardly fit into float32, by name."""
    shape = (SIZE, SIZE, 3)
    peak, plateau = np.full(shape, 0.5), np.full(shape, 0.2)
    peak[30, 30] = 1.0
    plateau[8:28, 8:28] = plateau[36:56, 36:56] = 0.8
    ulp = np.where(generator.random(shape) < 0.5, 0.5, np.nextafter(np.float32(0.5), 1))
    return {
        "all equal": np.full(shape, 0.5), "black": np.zeros(shape), "equal but for 1 ulp": ulp,
        "a single peak": peak, "two equal plateaus": plateau, "noise": generator.random(shape),
        "as dark as float32 goes": np.full(shape, 1e-45), "1e30": 1e30 * generator.random(shape),
        "1e-30": 1e-30 * generator.random(shape),
    }  # fmt: skip


def hard_views(generator):
    """Attend to a view of a hard silhouette in hard colours."""
    masks, colours = hard_masks(generator), hard_colours(generator)
    seen, painted = generator.choice(list(masks)), generator.choice(list(colours))
    normalisation = generator.choice(["local_maxima", "local_maxima", "iterative"])
    parameters = AttentionParameters(normalisation=str(normalisation))
    bend = generator.choice([0.0, 1.0, 1e30], (SIZE, SIZE))
    view = flat_view(colours[painted], masks[seen], bend)
    (found,) = attend(**view, parameters=parameters)
    yield from judge(found, masks[seen], f"{painted}, seen: {seen}", parameters)


def noisy_views(generator):
    """Attend to noise of any brightness within a random outline."""
    exponent = pick(generator, -30, 30)
    colour = generator.random((SIZE, SIZE, 3)) * 10.0**exponent
    smooth = ndimage.gaussian_filter(generator.normal(size=(SIZE, SIZE)), 4)
    mask = smooth >= np.quantile(smooth, pick(generator, 0, 1))
    parameters = AttentionParameters(inhibition_falloff=float(generator.integers(2)))
    view = flat_view(colour, mask, 10.0 ** generator.uniform(-3, 3, mask.shape))
    (found,) = attend(**view, parameters=parameters)
    yield from judge(found, mask, f"noise of 1e{exponent:.0f} on {mask.sum()} pixels", parameters)


def views_from_within(generator):
    """Attend to views of a camera inside an object, its centre and skin among the places."""
    distance = float(generator.choice([0.0, 1e-6, 0.3, 0.55, 0.9]))
    surface = ball(3) if generator.random() < 0.5 else lopsided()
    cameras = [Camera(azimuth, 20.0, distance, 40.0) for azimuth in (0.0, 135.0)]
    views, attended = look(surface, cameras, SIZE)
    for found, mask in zip(attended, views.mask, strict=True):
        label = f"camera at {distance:g} from the centre"
        yield from judge(found, mask, label, AttentionParameters())


def brightness(generator):
    """Make a view brighter by a power of two: no bit of the map changes."""
    power = int(generator.integers(-60, 61))
    mask = np.ones((SIZE, SIZE), dtype=bool)
    colour = generator.random((SIZE, SIZE, 3)).astype(np.float32)
    views = flat_view(colour, mask), flat_view(np.ldexp(colour, power), mask)
    (plain,), (scaled,) = (attend(**view, parameters=AttentionParameters()) for view in views)
    wrong = (plain.saliency != scaled.saliency).any()
    wrong |= (plain.scanpath.rows != scaled.scanpath.rows).any()
    yield Finding("attention/brightness by a power of two", wrong, f"noise times 2^{power}")


def way_of_the_eye(saliency, mask, places, parameters):
    """Follow the eye by its definition, in float64; stop where two places nearly tie."""
    depth, drive = drive_at_first(saliency, mask)
    allowed = mask & (depth > 3)
    way = []
    for _ in range(parameters.fixations):
        value = np.where(allowed, drive, -1.0)
        place = np.unravel_index(np.argmax(value), value.shape)
        best, value[place] = value[place], -1.0
        if best - value.max() < 2 * TIE_TOLERANCE + INWARD_WEIGHT * 0.05:
            break
        way.append(tuple(map(int, place)))
        distance = np.linalg.norm(places - places[place], axis=-1)
        drive = drive * recovery(distance, parameters)
        allowed &= distance > 1
    return way


def drive_at_first(saliency, mask):
    """Return how far pixels lie inside the outline, and what drives the eye before any fixation."""
    depth = ndimage.distance_transform_edt(np.pad(mask, 1))[1:-1, 1:-1]
    return depth, saliency.astype(float) + INWARD_WEIGHT * depth / depth.max()


def recovery(distance, parameters):
    """How much of the drive is left at a distance from a fixation, in foci."""
    progress = np.clip((distance - 1) / parameters.inhibition_falloff, 0, 1)
    return progress**2 * (3 - 2 * progress)


def inhibition(generator):
    """Compare the fixations of a random map with the definition of inhibition of return."""
    kind = str(generator.choice(["surface", "image"]))
    mask = np.hypot(*(np.indices((SIZE, SIZE)) - 31.5)) < 31
    # Levels five ties apart, on pixels well inside.
    pixels = np.flatnonzero(ndimage.binary_erosion(mask, iterations=5).ravel())
    levels = np.zeros(SIZE * SIZE)
    levels[generator.choice(pixels, 1200, replace=False)] = (
        0.4 + np.arange(1200) * 5 * TIE_TOLERANCE
    )
    saliency = levels.reshape(SIZE, SIZE)
    view = flat_view(np.zeros((SIZE, SIZE, 3)), mask)
    parameters = AttentionParameters(inhibition=kind)
    point = view["point"][0].astype(np.float64)
    on_pixels = np.moveaxis(np.indices(mask.shape), 0, -1) / (parameters.focus_fraction * SIZE)
    places = point / parameters.focus_radius if kind == "surface" else on_pixels
    wanted = way_of_the_eye(saliency, mask, places, parameters)
    normal, face = view["normal"][0], view["face"][0]
    path = scan(saliency.astype(np.float32), mask, point, normal, face, parameters)
    found = list(zip(path.rows.tolist(), path.columns.tolist(), strict=True))[: len(wanted)]
    yield Finding(
        "attention/way of the eye against its definition in float64",
        [place != right for place, right in zip(found, wanted, strict=True)],
        lambda row: f"fixation {row + 1} on random levels, inhibition on the {kind}",
    )


def pyramids(generator):
    """Blur, reduce and enlarge noise, and compare with SciPy."""
    side = 2 ** int(generator.integers(2, 8))
    plane = generator.random((side, side)).astype(np.float32)
    exact = plane.astype(np.float64)
    steps = np.clip((np.arange(2 * side) + 0.5) / 2 - 0.5, 0, side - 1)
    grid = np.meshgrid(steps, steps, indexing="ij")
    larger = ndimage.map_coordinates(exact, grid, order=1, mode="nearest")
    name, label = "attention/pyramid against scipy.ndimage", f"noise of {side}² pixels"
    yield Finding(name, np.abs(enlarge(plane, 2 * side) - larger).max(), label)
    for border, mode in ((BORDER_REPEATED, "nearest"), (BORDER_ZERO, "constant")):
        blurred = exact
        for axis in (0, 1):
            blurred = ndimage.correlate1d(blurred, [0.25, 0.5, 0.25], axis=axis, mode=mode)
        half = blurred.reshape(side // 2, 2, side // 2, 2).mean(axis=(1, 3))
        yield Finding(name, np.abs(blur(plane, border) - blurred).max(), label)
        yield Finding(name, np.abs(reduce(plane, border) - half).max(), label)


def sphere_curvature(generator):
    """Measure the curvature of a sphere, which is the same everywhere."""
    radius = float(generator.choice([1e-3, 0.5, 1.0, 10.0 ** generator.uniform(-3, 0)]))
    surface = of_trimesh(trimesh.creation.icosphere(4, radius=radius))
    # The reach of an edge's curvature and the largest curvedness scale with the surface.
    shape = measure_shape(surface, CREASE_WIDTH * radius)
    error = np.abs(shape.corner_curvature * radius - 1).max()
    label = f"a sphere of radius {radius:g}"
    yield Finding("attention/a uniform sphere's curvature", error, label)
