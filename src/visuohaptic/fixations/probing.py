"""Strategies: the ways to choose where to touch, and the points that they choose.

Heavy libraries are imported by the functions that use them, so that the strategies' names can
be checked without.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Literal

from visuohaptic.registry import Registry

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from visuohaptic.attention.parameters import AttentionParameters
    from visuohaptic.attention.scanpath import Scanpath
    from visuohaptic.fixations.locations import Look, Standpoint
    from visuohaptic.fixations.viewpoints import Camera
    from visuohaptic.geometry.raycasting import RayCaster
    from visuohaptic.geometry.surface import Surface

CANDIDATES = 4096
"""Points, uniform by area, among which `spread_far` chooses."""

SEEN_TOLERANCE = 1e-5
"""How much nearer than a point, as a share of its distance, what hides it must be."""

BATCH = 256
"""Points that are drawn at a time where only some are kept; it must not depend on how many are asked for."""

FRUITLESS_BATCHES = 64
"""Batches in a row without a seen point, after which a view counts as seeing nothing."""

SMALLEST_PEAK = 1e-30
"""A view of flat faces alone has no curvature; its map stays zero."""

Unreachable = Literal["replace", "keep"]
"""What is done with a place that the sensor can't reach."""


@dataclass(frozen=True)
class Strategy:
    """A way to choose where to touch.

    Attributes
    ----------
    name : str
        What parameters and tables call it.
    label : str
        What the report calls it.
    choose : callable
        Takes a viewpoint, the section `attention` and a generator; gives places in the order in
        which they are touched: a scan path where pixels of the view are chosen, otherwise
        points with outward normals. They are as many as `attention.fixations`, or fewer where
        there are no more; fewer are the first of more.
    random : bool
        Whether the generator changes the places.
    looks : bool
        Whether it needs the view and its saliency; one that does not takes any `Standpoint`.
    unreachable : {"replace", "keep"}, optional
        What is done with its places out of reach, whatever `probing.unreachable` says; without it
        as that says.
    chance : str, optional
        Name of its generators, also of the sensor's noise; without it its own name. Strategies
        with one name draw the same.
    uniform : bool
        Whether its places, those out of reach among them, are uniform over the surface, by area; a
        guard of the run holds it to that.
    """

    name: str
    label: str
    choose: Callable[[Look, AttentionParameters, np.random.Generator], Scanpath | ProbingLocations]
    random: bool = True
    looks: bool = True
    unreachable: Unreachable | None = None
    chance: str | None = None
    uniform: bool = False


@dataclass(frozen=True)
class ProbingLocations:
    """Points to touch, in order.

    Attributes
    ----------
    points : numpy.ndarray
        Shape (n, 3), float64, object frame.
    normals : numpy.ndarray
        Shape (n, 3), float64: unit normals, by the winding of the face.
    faces : numpy.ndarray
        Shape (n,), int64: the face on which each point lies.
    """

    points: NDArray[np.float64]
    normals: NDArray[np.float64]
    faces: NDArray[np.int64]

    def take(self, places: NDArray[np.int64]) -> ProbingLocations:
        """Give some of the locations, in the order of their places."""
        return ProbingLocations(self.points[places], self.normals[places], self.faces[places])


def draw_by_area(surface: Surface, count: int, generator: np.random.Generator) -> ProbingLocations:
    """Draw points uniformly over a surface, by area.

    Parameters
    ----------
    surface : Surface
        The object.
    count : int
        How many points; fewer points are the first of more.
    generator : numpy.random.Generator
        Where chance comes from.

    Returns
    -------
    ProbingLocations
        `count` points; hidden parts of the surface are as likely as visible ones.

    Notes
    -----
    A triangle is drawn by its share of the area, a point in it by the square-root
    map of the unit square (Osada et al., ACM Trans. Graph. 21(4), 2002, eq. 1).
    """
    import numpy as np

    cumulative = np.cumsum(surface.face_areas)
    drawn, outer, along = generator.random((count, 3)).T
    faces = np.searchsorted(cumulative, drawn * cumulative[-1], side="right")
    faces = np.minimum(faces, len(cumulative) - 1)
    root = np.sqrt(outer)
    weights = np.column_stack([1 - root, root * (1 - along), root * along])
    points = np.einsum("nc,nck->nk", weights, surface.triangles[faces])
    return ProbingLocations(points, surface.face_normals[faces], faces)


def draw_visible(
    caster: RayCaster, camera: Camera, count: int, generator: np.random.Generator
) -> ProbingLocations:
    """Draw points uniformly, by area, over what a viewpoint sees.

    Parameters
    ----------
    caster : RayCaster
        The object.
    camera : Camera
        The viewpoint.
    count : int
        How many points; fewer points are the first of more.
    generator : numpy.random.Generator
        Where chance comes from.

    Returns
    -------
    ProbingLocations
        `count` points with normals towards the camera, or fewer where it sees next to nothing.

    Notes
    -----
    Points are drawn over the whole surface and kept where the camera sees them. Pixels
    would weigh slanted parts less, and hold no place between them.
    """
    import numpy as np

    parts: list[ProbingLocations] = []
    found = fruitless = 0
    while found < count and fruitless < FRUITLESS_BATCHES:
        drawn = draw_by_area(caster.surface, BATCH, generator)
        parts.append(drawn.take(np.flatnonzero(sees(caster, camera, drawn.points))))
        found += len(parts[-1].faces)
        fruitless = 0 if len(parts[-1].faces) else fruitless + 1
    seen = _join(parts).take(np.arange(min(count, found)))
    return turn_towards(seen, camera)


def spread_far(surface: Surface, count: int, generator: np.random.Generator) -> ProbingLocations:
    """Spread points over a surface, each as far as can be from all before it.

    Parameters
    ----------
    surface : Surface
        The object.
    count : int
        How many points, at most `CANDIDATES`; fewer points are the first of more.
    generator : numpy.random.Generator
        Draws the first point, and the candidates among which the others are chosen.

    Returns
    -------
    ProbingLocations
        `count` points; their covering radius over the candidates is at most twice the least that
        so many points can reach (T. F. Gonzalez, Theor. Comput. Sci. 38, 1985).
    """
    candidates = draw_by_area(surface, CANDIDATES, generator)
    return candidates.take(farthest_order(candidates.points, count))


def farthest_order(points: NDArray[np.float64], count: int) -> NDArray[np.int64]:
    """Order points so that each is the farthest from those before it.

    Parameters
    ----------
    points : numpy.ndarray
        Shape (n, d), n at least 1; the first starts.
    count : int
        How many to take.

    Returns
    -------
    numpy.ndarray
        Shape (min(count, n),), int64: places, no place twice.
    """
    import numpy as np

    chosen = np.zeros(min(count, len(points)), dtype=np.int64)
    nearest = np.full(len(points), np.inf)
    for turn in range(1, len(chosen)):
        step = points - points[chosen[turn - 1]]
        nearest = np.minimum(nearest, np.einsum("nd,nd->n", step, step))
        # Equal points have distance 0 as taken ones do; these must not come again.
        nearest[chosen[:turn]] = -1.0
        chosen[turn] = np.argmax(nearest)
    return chosen


def sees(caster: RayCaster, camera: Camera, points: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Find which points of a surface a camera sees.

    Parameters
    ----------
    caster : RayCaster
        The object.
    camera : Camera
        The viewpoint; its view is a square about its axis.
    points : numpy.ndarray
        Shape (n, 3), float64, object frame, on the surface.

    Returns
    -------
    numpy.ndarray
        Shape (n,), bool: within the view, and not behind another part.
    """
    import numpy as np

    offsets = points - camera.eye
    across, along, towards = np.einsum("nd,kd->kn", offsets, camera.axes)
    depth = -towards
    half = 0.5 * camera.view_height / camera.distance
    reach = half * (camera.distance if camera.projection == "orthographic" else depth)
    within = (np.abs(across) <= reach) & (np.abs(along) <= reach) & (depth > 0)
    eyes = np.broadcast_to(camera.eye, points.shape)
    if camera.projection == "orthographic":
        eyes = points + depth[:, None] * camera.axes[2]
    distance = caster.first_hits(eyes, points - eyes).distance
    return within & (distance >= 1.0 - SEEN_TOLERANCE)


def turn_towards(locations: ProbingLocations, camera: Camera) -> ProbingLocations:
    """Turn normals to a camera that sees the points; one edge-on to it stays as it is."""
    import numpy as np

    towards = camera.eye - locations.points
    if camera.projection == "orthographic":
        towards = np.broadcast_to(camera.axes[2], locations.points.shape)
    away = np.einsum("nd,nd->n", locations.normals, towards) < 0
    normals = np.where(away[:, None], -locations.normals, locations.normals)
    return ProbingLocations(locations.points, normals, locations.faces)


def face_outwards(caster: RayCaster, locations: ProbingLocations) -> ProbingLocations:
    """Turn normals to the outside of an object."""
    from visuohaptic.geometry.orientation import orient_outwards

    outwards = orient_outwards(caster, locations.points, locations.normals)
    return ProbingLocations(locations.points, outwards, locations.faces)


def _join(parts: Sequence[ProbingLocations]) -> ProbingLocations:
    import numpy as np

    return ProbingLocations(
        np.concatenate([part.points for part in parts]),
        np.concatenate([part.normals for part in parts]),
        np.concatenate([part.faces for part in parts]),
    )


def _scan(one: Look, saliency: NDArray[np.float32], attention: AttentionParameters) -> Scanpath:
    from visuohaptic.attention.scanpath import scan

    seen, place = one.seen, one.place
    return scan(
        saliency,
        seen.mask[place],
        seen.point[place],
        seen.normal[place],
        seen.face[place],
        attention,
    )


def _follow_the_eye(one: Look, attention: AttentionParameters, *_: object) -> Scanpath:
    """Let the eye go on from where the look ended."""
    return _scan(one, one.attended.saliency, attention)


def _follow_curvature(one: Look, attention: AttentionParameters, *_: object) -> Scanpath:
    """Let the eye follow curvature alone, with the same inhibition of return."""
    import numpy as np

    curvature = one.seen.curvature[one.place]
    peak = max(float(curvature.max()), SMALLEST_PEAK)
    return _scan(one, curvature / np.float32(peak), attention)


def _look_as_people(one: Look, attention: AttentionParameters, *_: object) -> Scanpath:
    """Let the eye follow channels and terms by the weights that were fitted to people's gaze."""
    import numpy as np

    from visuohaptic.attention.model import attend
    from visuohaptic.attention.parameters import AttentionParameters

    human = AttentionParameters.model_validate({"weights": "human"})
    part = slice(one.place, one.place + 1)
    seen = one.seen
    (found,) = attend(
        seen.colour[part],
        seen.mask[part],
        seen.point[part],
        seen.normal[part],
        seen.face[part],
        seen.curvature[part],
        attention.model_copy(update={"weights": human.weights, "terms": human.terms}),
        np.array([one.camera.eye]),
    )
    return found.scanpath


def _follow_the_contour(one: Look, attention: AttentionParameters, *_: object) -> Scanpath:
    """Follow the object's outline from its most salient place, a focus radius a step."""
    from visuohaptic.attention.scanpath import Scanpath
    from visuohaptic.fixations.outline import follow_outline

    seen, place, saliency = one.seen, one.place, one.attended.saliency
    rows, columns = follow_outline(
        seen.mask[place],
        seen.point[place],
        saliency,
        attention.focus_radius,
        attention.fixations,
    )
    return Scanpath(
        rows=rows,
        columns=columns,
        points=seen.point[place][rows, columns],
        normals=seen.normal[place][rows, columns],
        faces=seen.face[place][rows, columns],
        saliency=saliency[rows, columns].astype("float64"),
        asked=attention.fixations,
    )


def _probe_anywhere(
    one: Standpoint, attention: AttentionParameters, generator: np.random.Generator
) -> ProbingLocations:
    drawn = draw_by_area(one.caster.surface, attention.fixations, generator)
    return face_outwards(one.caster, drawn)


def _probe_what_is_seen(
    one: Standpoint, attention: AttentionParameters, generator: np.random.Generator
) -> ProbingLocations:
    return draw_visible(one.caster, one.camera, attention.fixations, generator)


def _probe_far_apart(
    one: Standpoint, attention: AttentionParameters, generator: np.random.Generator
) -> ProbingLocations:
    spread = spread_far(one.caster.surface, attention.fixations, generator)
    return face_outwards(one.caster, spread)


def _walk(
    one: Standpoint, attention: AttentionParameters, generator: np.random.Generator
) -> ProbingLocations:
    from visuohaptic.fixations.walking import walk

    return walk(one.caster, attention.fixations, generator)


STRATEGIES = Registry(
    "probing strategy",
    Strategy("fixation", "eye fixations", _follow_the_eye, random=False),
    Strategy(
        "random",
        "random probing",
        _probe_anywhere,
        looks=False,
        unreachable="replace",
        uniform=True,
    ),
    Strategy(
        "random_anywhere",
        "random probing, out of reach too",
        _probe_anywhere,
        looks=False,
        unreachable="keep",
        chance="random",
        uniform=True,
    ),
    Strategy("random_visible", "random probing of what is seen", _probe_what_is_seen, looks=False),
    Strategy("random_walk", "a random walk over the surface", _walk, looks=False),
    Strategy("farthest_point", "farthest points", _probe_far_apart, looks=False),
    Strategy("curvature", "the most curved places", _follow_curvature, random=False),
    Strategy("contour", "places along the outline", _follow_the_contour, random=False),
    Strategy("human", "where people are predicted to look", _look_as_people, random=False),
)
"""Every strategy that places touches from a view or the surface, in the order of reports."""


StrategyName = Annotated[str, STRATEGIES]
