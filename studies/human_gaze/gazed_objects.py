"""Recorded objects: features in every view, and the time that people looked at the points of the surface."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from joblib import Parallel, delayed, parallel_config
from numpy.typing import NDArray
from scipy.sparse import csr_matrix
from scipy.spatial import cKDTree

from human_gaze.alignment import align, grey_surface, reconstruct
from human_gaze.peers import find_peer, read_peer
from human_gaze.recordings import (
    GazeError,
    Recording,
    RecordingFile,
    find_recordings,
    read_recording,
)
from human_gaze.surface_measures import GazedSurface
from visuohaptic.attention.channels import prepare_view
from visuohaptic.attention.model import reasons_to_skip, term_planes
from visuohaptic.attention.parameters import AttentionParameters
from visuohaptic.attention.plain_filters import plain_filters
from visuohaptic.attention.planes import Plane
from visuohaptic.attention.registry import CHANNELS, TERMS
from visuohaptic.attention.saliency import conspicuity_maps
from visuohaptic.attention.terms import SEEN, prepare_surface
from visuohaptic.base.arrays import BoolArray, FloatArray, IntArray
from visuohaptic.base.seeds import spawn_generator
from visuohaptic.fixations.parameters import RenderingParameters
from visuohaptic.fixations.places import draw_by_area, is_visible
from visuohaptic.fixations.rendering import render_views
from visuohaptic.fixations.viewpoints import Camera, place_cameras
from visuohaptic.geometry.raycasting import RayCaster
from visuohaptic.geometry.surface import Surface
from visuohaptic.meshes.model_files import read_mesh
from visuohaptic.meshes.preparing import normalise
from visuohaptic.parameters import ExperimentParameters

FEATURES = (*CHANNELS, *TERMS)
"""Features whose weighted sum is a prediction, in order."""

TURNING = ("front", "front_squared", "front_height", "side_squared")
"""Terms that change if an object turns about the vertical."""

COLUMNS = (*FEATURES, *(f"turned_{name}" for name in TURNING))
"""`FEATURES`, then the terms of `TURNING` with the object's front turned at random."""

MOST_EVALUATED = 4000
"""Largest number of recorded points of an object on which predictions are compared with people."""

AREA_SAMPLES = 100_000
REACH = 3.0
"""Radius of the Gaussian that spreads time, in standard deviations."""

Track = Callable[[list[Any]], Iterable[Any]]


@dataclass(frozen=True)
class GazeSettings:
    """Settings of reading recordings, spreading time over the surface, and fitting weights.

    Attributes
    ----------
    peer : path, optional
        Folder with predictions of others.
    largest_megabytes : float
        Largest file that is read, 10⁶ bytes.
    spread : float
        Standard deviation of the Gaussian that spreads time over the surface, object radii.
    largest_error : float
        Largest distance off the mesh of 95 % of the points of a recording, object radii.
    folds : int
        Parts of the objects that are held out in turn.
    penalty : float
        Penalty on squared weights of standardised features.
    """

    peer: Path | None = None
    largest_megabytes: float = 64.0
    spread: float = 0.04
    largest_error: float = 0.03
    folds: int = 6
    penalty: float = 0.001


@dataclass(frozen=True, eq=False)
class GazedObject:
    """Features of the views of an object, and where people looked on it.

    Attributes
    ----------
    name, digest : str
        Name of the object, and SHA-256 of its recording.
    is_test : bool
        Whether weights are never fitted on the object.
    surface : Surface
        The object, in the object frame.
    points : ndarray of shape (n, 3)
        Points of the surface: some of the recorded points.
    gazed : GazedSurface
        Time and area at the points.
    planes : ndarray of shape (v, k, m, m), float32
        `COLUMNS` of each view.
    shown : ndarray of shape (v, m, m), bool
        Cells of each view that show the object.
    cells : ndarray of shape (v, n)
        Cell of each point in each view, counted row by row.
    visible : ndarray of shape (v, n), bool
        Whether each view sees each point.
    error : float
        Distance off the mesh within which 95 % of the recorded points lie, object radii.
    is_reconstructed : bool
        Whether the surface was reconstructed from the points.
    seconds, seen_share : float
        Time that people looked at the object, s, and its share on points that a view sees.
    peer : ndarray of shape (n,), optional
        Prediction of others at the points.
    """

    name: str
    is_test: bool
    digest: str
    surface: Surface
    points: FloatArray
    gazed: GazedSurface
    planes: NDArray[np.float32]
    shown: BoolArray
    cells: IntArray
    visible: BoolArray
    error: float
    is_reconstructed: bool
    seconds: float
    seen_share: float
    peer: FloatArray | None = None

    @property
    def family(self) -> str:
        """Name without a number at its end; poses of one figure share the name, and are never in two folds."""
        return self.name.rstrip("0123456789") or self.name

    @cached_property
    def features(self) -> FloatArray:
        """Features of each point, averaged over the views that see the point, shape (n, k); zero if no view does."""
        views, kinds = self.planes.shape[:2]
        total = np.zeros((self.visible.shape[1], kinds))
        for view in range(views):
            at_points = self.planes[view].reshape(kinds, -1)[:, self.cells[view]]
            total += (at_points * self.visible[view]).T
        return total / np.maximum(self.visible.sum(axis=0), 1)[:, None]


def look_at_folder(
    folder: str | Path,
    parameters: ExperimentParameters,
    settings: GazeSettings,
    processes: int = 1,
    track: Track = iter,
    *,
    tests: bool = True,
) -> list[GazedObject]:
    """Return every recorded object in a folder, sorted by name; without `tests`, objects for tests are left out.

    `folder` has recordings and meshes. ``track(files)`` returns the files, and may print progress. Raises `GazeError`
    or `MeshError` for the first recording or mesh that can't be used.
    """
    files = [file for file in find_recordings(folder) if tests or not file.is_test]
    if not files:
        raise GazeError(
            f"{folder} has only recordings for tests; recordings for training are needed."
        )
    if settings.peer and not any(find_peer(settings.peer, file.name) for file in files):
        raise GazeError(
            f"{settings.peer} has no prediction for any recorded object; files such as {files[0].name}.ply "
            "are needed."
        )
    # Otherwise each process would use as many threads as the environment allows.
    with parallel_config(backend="loky", inner_max_num_threads=1):
        jobs = Parallel(processes)(
            delayed(look_at)(file, parameters, settings) for file in track(files)
        )
    return list(jobs)


def look_at(
    file: RecordingFile, parameters: ExperimentParameters, settings: GazeSettings
) -> GazedObject:
    """Read a recording and its mesh, and compute the features of the object from every viewpoint.

    All channels run, whatever their weights in `parameters`, because weights are fitted later. Raises `GazeError` if the
    recording can't be read or does not fit the mesh, and `MeshError` if the mesh can't be read.
    """
    seed = parameters.seed
    recording = read_recording(file.gaze, settings.largest_megabytes)
    if file.mesh is None:
        raw = reconstruct(recording)
    else:
        mesh = read_mesh(file.mesh, largest_megabytes=settings.largest_megabytes)
        raw = grey_surface(mesh.vertices, mesh.faces)
    points = _recorded_points(recording, raw)
    surface = normalise(raw, file.name).surface
    caster = RayCaster(surface)
    placed, error = align(points, caster, file.name, settings.largest_error)
    area, density = _spread(placed, recording.seconds, surface, settings.spread, seed)
    generator = spawn_generator(seed, "gaze", file.name)
    count = min(MOST_EVALUATED, len(points))
    chosen = np.sort(generator.choice(len(points), count, replace=False))
    cameras = place_cameras(parameters.viewpoints)
    chosen_points = placed[chosen]
    sighted = np.stack([is_visible(caster, camera, placed) for camera in cameras])
    visible = sighted[:, chosen]
    front = spawn_generator(seed, "gaze front", file.name)
    every = AttentionParameters.model_validate({"weights": "equal"}).weights
    attention = parameters.attention.model_copy(update={"weights": every})
    planes, shown = _planes_of_views(caster, cameras, parameters.rendering, attention, front)
    seen: BoolArray = np.asarray(visible.any(axis=0))
    if not (density[chosen] * area[chosen])[seen].sum() > 0:
        raise GazeError(
            f"{file.name}: no viewpoint sees a point that people looked at; other viewpoints are needed."
        )
    return GazedObject(
        name=file.name,
        is_test=file.is_test,
        digest=recording.digest,
        surface=surface,
        points=chosen_points,
        gazed=GazedSurface(density[chosen], area[chosen], seen),
        planes=planes,
        shown=shown,
        cells=np.stack([_cells(camera, chosen_points, planes.shape[-1]) for camera in cameras]),
        visible=visible,
        error=error,
        is_reconstructed=file.mesh is None,
        seconds=float(recording.seconds.sum()),
        seen_share=float(recording.seconds[sighted.any(axis=0)].sum() / recording.seconds.sum()),
        peer=_predicted_by_peer(chosen_points, caster, file.name, settings),
    )


def _recorded_points(recording: Recording, mesh: Surface) -> FloatArray:
    if recording.points is not None:
        return recording.points
    if len(recording.seconds) != len(mesh.vertices):
        raise GazeError(
            f"{recording.name} has {len(recording.seconds)} times and its mesh {len(mesh.vertices)} "
            "vertices; one time per vertex is needed."
        )
    return mesh.vertices


def _spread(
    points: FloatArray, seconds: FloatArray, surface: Surface, spread: float, seed: int
) -> tuple[FloatArray, FloatArray]:
    """Compute the area of each recorded point, and the time per area around the point by a Gaussian."""
    tree = cKDTree(points)
    drawn = draw_by_area(surface, AREA_SAMPLES, spawn_generator(seed, "gaze area"))
    nearest = tree.query(drawn.points)[1]
    area = np.bincount(nearest, minlength=len(points)) * (surface.face_areas.sum() / AREA_SAMPLES)
    pairs = tree.query_pairs(REACH * spread, output_type="ndarray")
    first, second = pairs.T
    squared = ((points[first] - points[second]) ** 2).sum(axis=1)
    near = np.exp(-squared / (2 * spread**2))
    half = csr_matrix((near, (first, second)), shape=(len(points), len(points)))
    time = seconds + half @ seconds + half.T @ seconds
    around = area + half @ area + half.T @ area
    return area, np.divide(time, around, out=np.zeros_like(time), where=around > 0)


def _predicted_by_peer(
    points: FloatArray, caster: RayCaster, name: str, settings: GazeSettings
) -> FloatArray | None:
    file = find_peer(settings.peer, name) if settings.peer else None
    if file is None:
        return None
    theirs, values = read_peer(file, settings.largest_megabytes)
    placed, _ = align(theirs, caster, str(file), settings.largest_error)
    nearest_values: FloatArray = values[cKDTree(placed).query(points)[1]]
    return nearest_values


def _planes_of_views(
    caster: RayCaster,
    cameras: list[Camera],
    rendering: RenderingParameters,
    attention: AttentionParameters,
    front: np.random.Generator,
) -> tuple[NDArray[np.float32], BoolArray]:
    """Compute `COLUMNS` of each view, and the cells that show the object; `front` draws the turn of the object."""
    planes, shown = [], []
    angle = front.uniform(0, 2 * np.pi)
    cosine, sine = np.cos(angle), np.sin(angle)
    turn = np.array([[cosine, 0, -sine], [0, 1, 0], [sine, 0, cosine]])
    seen = render_views(caster, cameras, rendering)
    for view, camera in enumerate(cameras):
        plane_of, certainty = feature_planes(
            seen.colour[view],
            seen.mask[view],
            seen.point[view],
            seen.normal[view],
            seen.curvature[view],
            camera.eye,
            attention,
        )
        turned = prepare_surface(
            seen.mask[view], seen.point[view] @ turn, seen.normal[view], camera.eye
        )
        plane_of |= {
            f"turned_{name}": plane for name, plane in term_planes(turned, TURNING).items()
        }
        planes.append(np.stack([plane_of[name] for name in COLUMNS]))
        shown.append(certainty > SEEN)
    return np.stack(planes), np.stack(shown)


@plain_filters()
def feature_planes(
    colour: Plane,
    mask: BoolArray,
    point: FloatArray,
    normal: FloatArray,
    curvature: Plane,
    eye: FloatArray,
    parameters: AttentionParameters,
) -> tuple[dict[str, Plane], Plane]:
    """Compute `FEATURES` of one view, and the share of each cell that shows the object.

    The arguments are those of `attend`. Results are planes (MAP_SIZE, MAP_SIZE), float32: every channel, then every term.
    A channel that is skipped has zeros.
    """
    skipped = reasons_to_skip(colour, mask, curvature, parameters)
    ran = tuple(name for name in CHANNELS if name not in skipped)
    maps = conspicuity_maps(prepare_view(colour, mask, curvature), ran, parameters)
    seen = prepare_surface(mask, point, normal, eye)
    nothing = np.zeros_like(seen.certainty)
    planes = {name: maps.get(name, nothing) for name in CHANNELS}
    return planes | term_planes(seen, TERMS), seen.certainty


def _cells(camera: Camera, points: FloatArray, size: int) -> IntArray:
    """Return the grid cell of each point in a view; points outside of the view are moved to its edge."""
    right, up, back = camera.axes
    offset = points - camera.eye
    depth = np.full(len(points), camera.distance)
    if camera.projection == "perspective":
        depth = np.maximum(-(offset @ back), 1e-9)
    half = 0.5 * camera.view_height / camera.distance * depth
    columns = np.clip((offset @ right / half + 1) * 0.5 * size, 0, size - 1).astype(np.int64)
    rows = np.clip((1 - offset @ up / half) * 0.5 * size, 0, size - 1).astype(np.int64)
    return rows * size + columns
