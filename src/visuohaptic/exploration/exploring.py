"""One object from its mesh file to its class, without the workflow and with the same results."""

from __future__ import annotations

import time
import warnings
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pyarrow as pa
from numpy.typing import ArrayLike, NDArray
from tqdm.auto import tqdm

from visuohaptic.base.arrays import FloatArray
from visuohaptic.base.atomic_files import unfinished_folder
from visuohaptic.base.errors import MeshError, MeshWarning, ParameterError
from visuohaptic.exploration.file_frame import FileFrame
from visuohaptic.exploration.next_touch import FeltTouch, touch_next_point
from visuohaptic.exploration.picture import draw_exploration
from visuohaptic.exploration.pose_files import write_poses
from visuohaptic.exploration.recognising import (
    GIVEN,
    UNKNOWN,
    Recogniser,
    caution_about,
    check_acquired,
    check_alike,
    read_recogniser,
)
from visuohaptic.exploration.showing import (
    VIEWS_SHOWN,
    png_of,
    probability_line,
    probability_table,
    view_of,
)
from visuohaptic.exploration.sources import is_one_source, mesh_parameters, read_source
from visuohaptic.exploration.touching import (
    SCHEMAS,
    Track,
    touch_given_points,
    touch_seen_points,
)
from visuohaptic.fixations.probing import is_policy
from visuohaptic.geometry.surface import Surface
from visuohaptic.meshes.parameters import MeshParameters
from visuohaptic.parameters import ExperimentParameters, as_parameters, check_run
from visuohaptic.tables.schema import images, write_table

if TYPE_CHECKING:
    from PIL.Image import Image

    from visuohaptic.meshes.model_files import Source

Parameters = ExperimentParameters | Mapping[str, Any]


@dataclass(frozen=True, eq=False)
class TouchableObject:
    """An object made ready for the eye and the hand; it is equal to itself alone.

    Attributes
    ----------
    key : str
        `class/name`; the class is ``unknown`` where it is not given.
    surface : Surface
        In the object frame.
    seconds : float
        What reading and preparing it took.
    frame : FileFrame
        The frame of the file that it came from.
    """

    key: str
    surface: Surface
    seconds: float
    frame: FileFrame = field(default_factory=lambda: FileFrame(np.eye(4)))

    def __repr__(self) -> str:
        return f"<TouchableObject {self.key}: {len(self.surface.faces):,} triangles>"

    def _repr_png_(self) -> bytes:
        return view_of(self.surface)

    def touch(
        self,
        viewpoints: int | None = None,
        strategy: str = "fixation",
        parameters: Parameters | None = None,
        track: Track = iter,
        *,
        at: ArrayLike | None = None,
        normals: ArrayLike | None = None,
    ) -> Exploration:
        """Look at the object from all around, and set the sensor down on it.

        Parameters
        ----------
        viewpoints : int, optional
            Viewpoints on each ring; without it as `parameters` say.
        strategy : str
            How the probing locations are chosen: a strategy, or a policy.
        parameters : ExperimentParameters or mapping, optional
            Everything else, such as ``{"sensor.resolution": 16}``; what is left out takes
            its default, which is that of the paper.
        track : callable
            Takes the steps of the work and gives them back one by one, as a progress
            bar such as ``tqdm.tqdm`` does.
        at : array_like, optional
            Shape (n, 3), object frame: where to touch, instead of looking. The sensor is set
            down at the surface's nearest point.
        normals : array_like, optional
            Shape (n, 3), object frame, of any length: which way is out at each of `at`;
            without them as the surface has it.

        Returns
        -------
        Exploration
            What was seen and felt; the same as the workflow finds for the same key.

        Raises
        ------
        ParameterError
            If a parameter, the strategy or a point is not allowed.
        MeshError
            If no viewpoint sees a place to touch, or a policy makes no touch.
        """
        chosen = self._sized(parameters)
        if at is None and normals is None:
            rings = {} if viewpoints is None else {"count": viewpoints}
            probing = {"strategies": (strategy,)}
            chosen = _changed(chosen, "touch", probing=probing, viewpoints=rings)
            check_run(chosen, "touch")
            tables, seconds = touch_seen_points(self.key, self.surface, chosen, track)
            if not tables["touches"].num_rows:
                if is_policy(strategy):
                    raise MeshError(
                        f"policy {strategy} made no touch of {self.key}: it stopped before the first, or no "
                        "sensor comes to its places."
                    )
                raise MeshError(
                    f"{self.key} shows no viewpoint a place to touch: it is thinner than a pixel of the "
                    "view, or no sensor comes there; a larger rendering.resolution or strategy random touches it."
                )
        elif at is None:
            raise ParameterError("normals need at: the points that they stand on.")
        elif viewpoints is not None:
            raise ParameterError("at leaves no choice of viewpoints: leave one of the two out.")
        else:
            check_run(chosen, "touch")
            strategy = GIVEN
            tables, seconds = touch_given_points(self.key, self.surface, at, normals, chosen)
        seconds = {"prepare": self.seconds, **seconds}
        return Exploration(self.key, self.surface, chosen, strategy, seconds, tables, self.frame)

    def _sized(self, values: Parameters | None) -> ExperimentParameters:
        """Let the scene have the object's real size, where its file's unit is known and nobody says otherwise."""
        parameters = as_parameters(values)
        scene = parameters.scene
        if self.frame.radius_m is None or "object_radius_m" in scene.model_fields_set:
            return parameters
        size = {"object_radius_m": self.frame.radius_m}
        return _changed(parameters, "the object's size", scene=size)


@dataclass(frozen=True, eq=False)
class Exploration:
    """What the eye saw of an object, and what the hand felt; it is equal to itself alone.

    Attributes
    ----------
    key : str
        `class/name` of the object.
    surface : Surface
        The object.
    parameters : ExperimentParameters
        How it was explored.
    strategy : str
        How the probing locations were chosen; ``given`` where the caller chose them.
    seconds : mapping of str to float
        What each phase took: prepare, look, touch, describe; and what a policy took to choose.
    tables : mapping of str to pyarrow.Table
        ``views``, ``fixations``, ``touches``, ``effects`` and ``features``, which are attributes, too, in
        the object frame; ``frame.table(touches)`` gives one in the file's. ``visuohaptic tables`` lists
        their columns.
    frame : FileFrame
        The frame of the object's file.
    """

    key: str
    surface: Surface
    parameters: ExperimentParameters
    strategy: str
    seconds: Mapping[str, float]
    tables: Mapping[str, pa.Table]
    frame: FileFrame = field(default_factory=lambda: FileFrame(np.eye(4)))

    def __repr__(self) -> str:
        touches, seconds = self.touches.num_rows, sum(self.seconds.values())
        how = (
            f"from {self.views.num_rows} viewpoints by {self.strategy}"
            if self.views.num_rows
            else "at given points"
        )
        return f"<Exploration of {self.key}: {touches} touches {how}, {seconds:.2f} s>"

    def _repr_png_(self) -> bytes:
        views = self.views.slice(0, VIEWS_SHOWN)
        return png_of(draw_exploration(self.surface, self.parameters, views, self.touches))

    @property
    def views(self) -> pa.Table:
        """What was seen."""
        return self.tables["views"]

    @property
    def fixations(self) -> pa.Table:
        """Where to touch."""
        return self.tables["fixations"]

    @property
    def touches(self) -> pa.Table:
        """What was felt."""
        return self.tables["touches"]

    @property
    def effects(self) -> pa.Table:
        """Why each effect was needed."""
        return self.tables["effects"]

    @property
    def features(self) -> pa.Table:
        """What describes the touches."""
        return self.tables["features"]

    @property
    def imprints(self) -> NDArray[np.float32]:
        """What the sensor felt, shape (n, r, r), float32, in [0, 1], in the order of `touches`.

        1 is contact and 0 is out of reach; r is the sensor's resolution.
        """
        return images(self.touches)

    @property
    def poses(self) -> FloatArray:
        """Poses of the touches in the file's frame, shape (n, 4, 4), as `FileFrame.poses` gives them."""
        return self.frame.poses(self.touches)

    def touch_next(
        self, point: ArrayLike, normal: ArrayLike | None = None
    ) -> tuple[Exploration, FeltTouch]:
        """Touch one more point, after ``touch(at=...)``.

        The result is that of ``touch(at=...)`` with all points. A place that the sensor can't reach is
        touched as far as the sensor comes, and is not `acquired`.

        Parameters
        ----------
        point : array_like of shape (3,)
            Where to touch, object frame. The sensor is set down at the surface's nearest point.
        normal : array_like of shape (3,), optional
            Which way is out, of any length; without it as the surface has it.

        Returns
        -------
        exploration : Exploration
            All touches so far.
        felt : FeltTouch
            The imprint, the features, and whether the sensor could reach the place.

        Raises
        ------
        ParameterError
            If the touches so far were made by a strategy, or point or normal is not allowed.

        Examples
        --------
        >>> import visuohaptic as vh
        >>> made = vh.example("chair").touch(at=[[0.1, -0.1, 0.4]])
        >>> made, felt = made.touch_next([-0.2, 0.3, -0.2])
        >>> made.touches.num_rows, felt.imprint.shape
        (2, (32, 32))
        """
        if self.strategy != GIVEN:
            raise ParameterError(
                f"The object was touched by strategy {self.strategy}; touch_next goes on from touch(at=...)."
            )
        (tables, seconds), felt = touch_next_point(
            self.key, self.surface, point, normal, self.parameters, dict(self.tables)
        )
        added = {name: self.seconds.get(name, 0.0) + part for name, part in seconds.items()}
        made = replace(self, tables=tables, seconds={**self.seconds, **added})
        return made, felt

    def recognise(self, model: str | Path | Recogniser | None = None) -> Recognition:
        """Classify the object from its touches, by any strategy or at given points.

        Parameters
        ----------
        model : path or Recogniser
            A fitted model, or where one lies.

        Returns
        -------
        Recognition
            The likeliest class, how likely each is, and how sure that is. For touches by a strategy that
            the model did not learn from, a sentence (`Recognition.caution`) takes the place of prediction
            set and strangeness.

        Raises
        ------
        RecognitionError
            If there is no such model, it learnt from touches with other parameters, or the object has no
            touch in the sensor's reach.
        """
        recogniser = model if isinstance(model, Recogniser) else read_recogniser(model)
        check_alike(self.parameters, recogniser)
        if self.strategy == GIVEN:
            check_acquired(self.features, self.parameters)
        started = time.perf_counter()
        found = recogniser.model.answer(self.features)
        seconds = {**self.seconds, "recognise": time.perf_counter() - started}
        name = UNKNOWN if found.unknown else next(iter(found.probabilities))
        return Recognition(
            name,
            found.probabilities,
            self,
            self.features.num_rows,
            seconds,
            found.candidates,
            found.strangeness,
            found.unknown,
            found.coverage,
            caution_about(self.strategy, recogniser),
        )

    def picture(self) -> Image:
        """Draw the views with the numbered touches and the sensor's squares, and the imprints.

        Returns
        -------
        PIL.Image.Image
            The picture.
        """
        return draw_exploration(self.surface, self.parameters, self.views, self.touches)

    def save(self, folder: str | Path) -> list[Path]:
        """Write every table, the picture, and the touches' poses in the frame of the object's file, as CSV.

        Parameters
        ----------
        folder : path
            Where to; made where missing. The names of the files do not depend on the object,
            and all of them appear once the last is written.

        Returns
        -------
        list of pathlib.Path
            The files.
        """
        folder = Path(folder)
        poses = ["poses.csv"] if self.frame.has_way_back else []
        names = [*(f"{name}.parquet" for name in SCHEMAS), *poses, "picture.png"]
        there = next(path for path in (folder, *folder.absolute().parents) if path.is_dir())
        with unfinished_folder(there) as waiting:
            for name, schema in SCHEMAS.items():
                write_table(schema, self.tables[name], waiting / f"{name}.parquet")
            for name in poses:
                write_poses(self.poses, waiting / name)
            self.picture().save(waiting / "picture.png")
            folder.mkdir(parents=True, exist_ok=True)
            for name in names:
                (waiting / name).replace(folder / name)
        return [folder / name for name in names]


@dataclass(frozen=True, eq=False)
class Recognition:
    """The class that was predicted for an object; it is equal to itself alone.

    Attributes
    ----------
    name : str
        The likeliest class, or ``unknown`` where the object is of no class that the model knows.
    probabilities : mapping of str to float
        Of every class that the model knows, the likeliest first.
    exploration : Exploration
        What the answer rests on.
    touches : int
        Touches that the answer rests on.
    seconds : mapping of str to float
        What each phase took: prepare, look, touch, describe, recognise.
    candidates : tuple of str or None
        The prediction set, the likeliest first, made so that of objects of known classes the share
        `coverage` has its class in it, which is measured and not guaranteed (docs/recognition.md). None, as
        the three attributes that follow, where the model is not calibrated for such touches.
    strangeness : float or None
        The share of known objects, this one counted among them, that are less strange than it.
    unknown : bool or None
        Whether that is more than `coverage`.
    coverage : float or None
        The stated share.
    caution : str or None
        A sentence with the strategies that the model learnt from and the strategy of these touches, where
        the model did not learn from it.
    """

    name: str
    probabilities: Mapping[str, float]
    exploration: Exploration
    touches: int
    seconds: Mapping[str, float]
    candidates: tuple[str, ...] | None = None
    strangeness: float | None = None
    unknown: bool | None = None
    coverage: float | None = None
    caution: str | None = None

    def __repr__(self) -> str:
        line = probability_line(self.probabilities)
        if self.unknown:
            line = f"{UNKNOWN} ({line})"
        caution = "" if self.caution is None else f". {self.caution}"
        return (
            f"<Recognition of {self.exploration.key}: {line}; from {self.touches} touches{caution}>"
        )

    def _repr_html_(self) -> str:
        key = self.exploration.key
        named = f"{key}: {UNKNOWN}" if self.unknown else key
        return probability_table(named, self.probabilities, self.touches, self.caution)


def load(
    source: Source,
    key: str | None = None,
    parameters: MeshParameters | Parameters | None = None,
    file_type: str | None = None,
    unit: str | None = None,
) -> TouchableObject:
    """Read an object and make it ready.

    Parameters
    ----------
    source : path, binary file, trimesh.Trimesh or Scene, open3d TriangleMesh, (vertices, faces) or Surface
        A mesh file, or a packed model of the repository
        (``meshes/paper/<class>/<name>.ply.gz``), which is turned and stretched as
        the catalogue above it says; a mesh in memory; or two arrays, shapes (v, 3) and (f, 3).
    key : str, optional
        `class/name`; random numbers depend on it and the seed. Without it the class is
        ``unknown``, or the catalogue's, and the name the file's.
    parameters : MeshParameters, ExperimentParameters or mapping, optional
        Which axis points up, and tolerances: section `meshes`, or all parameters.
    file_type : str, optional
        Format of an open file, such as ``obj``; without it as its name ends.
    unit : {"mm", "cm", "m", "in"}, optional
        The source's unit of length. With it the scene's effects know the object's real size; without it
        they take `scene.object_radius_m`.

    Returns
    -------
    TouchableObject
        The object.

    Raises
    ------
    MeshError
        If the source can't be read or has nothing to touch, the key is no `class/name`, or the unit is none.
    ParameterError
        If a parameter is not allowed.

    Warns
    -----
    MeshWarning
        If the source was read without a file that it refers to, or is probably not y-up; the sentences are
        ``surface.notes``, too.
    """
    started = time.perf_counter()
    if key is not None and (key.count("/") != 1 or not all(key.split("/"))):
        raise MeshError(f"{key!r} is no key of an object; 'class/name' is allowed.")
    found, surface, way = read_source(source, file_type, mesh_parameters(parameters))
    for note in surface.notes:
        warnings.warn(note, MeshWarning, stacklevel=2)
    seconds = time.perf_counter() - started
    return TouchableObject(found if key is None else key, surface, seconds, FileFrame(way, unit))


def touch(
    sources: Source | TouchableObject | Iterable[Source | TouchableObject],
    viewpoints: int | None = None,
    strategy: str = "fixation",
    parameters: Parameters | None = None,
    track: Callable[[Sequence[TouchableObject]], Iterable[TouchableObject]] | None = None,
) -> list[Exploration]:
    """Touch several objects, one after the other.

    Parameters
    ----------
    sources : iterable
        Objects, or what `load` makes them from; one alone needs no list.
    viewpoints, strategy, parameters
        As in `TouchableObject.touch`; the same for all.
    track : callable, optional
        Takes the objects and gives them back one by one; without it a progress bar.

    Returns
    -------
    list of Exploration
        One an object, in their order.

    Raises
    ------
    MeshError
        If one of them can't be read; nothing is touched then.
    ParameterError
        If a choice is not allowed.
    """
    chosen = as_parameters(parameters)
    several: Any = [sources] if is_one_source(sources) else sources
    ready = [
        one if isinstance(one, TouchableObject) else load(one, parameters=chosen) for one in several
    ]
    if track is None:
        # A bar for work that takes long enough to wait for.
        track = partial(tqdm, desc="touching", unit="object", delay=1, leave=False)
    return [one.touch(viewpoints, strategy, chosen) for one in track(ready)]


def _changed(
    parameters: ExperimentParameters, source: str, **sections: dict[str, Any]
) -> ExperimentParameters:
    # What the caller has left to its default stays so: nobody asked for it.
    values = parameters.model_dump(exclude_unset=True)
    for name, choices in sections.items():
        values[name] = {**values.get(name, {}), **choices}
    return ExperimentParameters.from_mapping(values, source)
