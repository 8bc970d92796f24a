"""Load, touch and recognise objects in Python, with the same results as the workflow."""

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

from visuohaptic.active.registry import is_policy
from visuohaptic.base.arrays import FloatArray
from visuohaptic.base.atomic_files import unfinished_folder
from visuohaptic.base.errors import MeshError, MeshWarning, ParameterError
from visuohaptic.exploration.file_frame import FileFrame
from visuohaptic.exploration.looking import exploration_figure, object_figure, show_figure
from visuohaptic.exploration.next_touch import FeltTouch, touch_next_point
from visuohaptic.exploration.picture import draw_exploration, draw_first_view
from visuohaptic.exploration.pose_files import write_poses
from visuohaptic.exploration.quarter_turns import classes_when_turned, note_on_front
from visuohaptic.exploration.recognising import (
    GIVEN,
    UNKNOWN,
    Recogniser,
    caution_about,
    check_acquired,
    check_compatible,
    note_on_few_objects,
    read_recogniser,
    set_phrase,
)
from visuohaptic.exploration.showing import (
    picture_with_line,
    probability_line,
    probability_table,
    small_png_of,
    view_of,
)
from visuohaptic.exploration.sources import (
    UP_ADVICE,
    is_one_source,
    mesh_parameters,
    model_of,
    with_axes,
)
from visuohaptic.exploration.touching_points import (
    SCHEMAS,
    Track,
    touch_given_points,
    touch_seen_points,
)
from visuohaptic.geometry.surface import Surface
from visuohaptic.meshes.parameters import MeshParameters
from visuohaptic.meshes.preparing import prepare_object
from visuohaptic.parameters import ExperimentParameters, as_parameters, check_run
from visuohaptic.tables.schema import readings, write_table

if TYPE_CHECKING:
    from PIL.Image import Image

    from visuohaptic.meshes.model_files import Source

Parameters = ExperimentParameters | Mapping[str, Any]

_ARGUMENTS = {"probing.strategies.0": "strategy", "viewpoints.count": "viewpoints"}
"""Argument of `touch` per parameter that the argument sets, for errors."""


@dataclass(frozen=True, eq=False)
class TouchableObject:
    """An object in the object frame, as `load` returns it. Objects are compared by identity.

    Attributes
    ----------
    key : str
        `class/name`; the class is ``unknown`` if it was not given.
    surface : Surface
        The mesh in the object frame: its centroid is the origin, y points up, z to the front, and the farthest
        vertex has distance 1.
    seconds : float
        Wall time of reading and preparing the mesh (s).
    frame : FileFrame
        Transformation between the frame of the mesh file and the object frame; by default the identity.
    """

    key: str
    surface: Surface
    seconds: float
    frame: FileFrame = field(default_factory=lambda: FileFrame(np.eye(4)))

    def __repr__(self) -> str:
        return f"<TouchableObject {self.key}: {len(self.surface.faces):,} triangles>"

    def _repr_html_(self) -> str:
        line = f"{self.key}: {len(self.surface.faces):,} triangles; show() turns it"
        return picture_with_line(view_of(self.surface), line)

    def show(self, path: str | Path | None = None) -> Path | None:
        """Show the object as a model that can be turned, in a notebook or in the browser.

        Parameters
        ----------
        path : path, optional
            HTML file to write, which is then not opened. By default the model is shown in the notebook; outside of a
            notebook, a new file is opened in the browser.

        Returns
        -------
        pathlib.Path or None
            The file, one page that needs no network; None in a notebook without `path`.

        Raises
        ------
        ParameterError
            If `path` is a folder.
        """
        line = f"{len(self.surface.faces):,} triangles in the object frame: y is up, and viewpoint 0 is on the side of +z."
        return show_figure(object_figure(self.key, self.surface), line, path)

    def touch(
        self,
        viewpoints: int | None = None,
        strategy: str | None = None,
        parameters: Parameters | None = None,
        track: Track = iter,
        *,
        at: ArrayLike | None = None,
        normals: ArrayLike | None = None,
    ) -> Exploration:
        """Touch the object at locations that a strategy chooses per viewpoint, or at given points.

        Parameters
        ----------
        viewpoints : int, optional
            Number of viewpoints on each ring around the object; by default `viewpoints.count` of `parameters`.
            Not allowed with `at`.
        strategy : str, optional
            Name of a strategy or policy of `STRATEGIES`, which chooses the probing locations; by default
            ``fixation``. Not allowed with `at`.
        parameters : ExperimentParameters or mapping, optional
            All other parameters, such as ``{"sensor.resolution": 16}``. Missing parameters take the
            paper's values, which are the defaults.
        track : callable
            Takes the sequence of steps and yields each step, as ``tqdm.tqdm`` does for a progress bar.
            Ignored with `at`.
        at : array_like, optional
            Shape (n, 3), object frame: points to touch. No view is rendered then. Each touch is at the nearest
            point of the surface, which must be within 0.1 object radii.
        normals : array_like, optional
            Shape (n, 3), object frame, of any length above 0: outward directions of the sensor at the points
            `at`. By default the outward normals of the surface.

        Returns
        -------
        Exploration
            The views, touches and features. For the same key and parameters they equal the workflow's results.

        Raises
        ------
        ParameterError
            If a parameter, the strategy, a point or a normal is not allowed, or `normals` come without `at`.
        MeshError
            If no location is touched: no viewpoint sees any location in reach, or a policy stops before its
            first touch.
        """
        chosen = self._with_real_size(parameters)
        if at is None and normals is None:
            chooser = "fixation" if strategy is None else strategy
            return self._touch_seen_points(viewpoints, chooser, chosen, track)
        if at is None:
            raise ParameterError(
                "normals are given without at; pass the points of the normals as at."
            )
        for name, value in (("viewpoints", viewpoints), ("strategy", strategy)):
            if value is not None:
                raise ParameterError(f"at and {name} are both given; pass only one of the two.")
        check_run(chosen, "touch")
        tables, seconds = touch_given_points(self.key, self.surface, at, normals, chosen)
        return self._exploration(GIVEN, chosen, tables, seconds)

    def _touch_seen_points(
        self, viewpoints: int | None, strategy: str, parameters: ExperimentParameters, track: Track
    ) -> Exploration:
        """Touch locations that `strategy` chooses per viewpoint. Raises `MeshError` if no location is touched."""
        rings = {} if viewpoints is None else {"count": viewpoints}
        probing = {"strategies": (strategy,)}
        chosen = _with_values(parameters, "touch", probing=probing, viewpoints=rings)
        check_run(chosen, "touch")
        tables, seconds = touch_seen_points(self.key, self.surface, chosen, track)
        if tables["touches"].num_rows:
            return self._exploration(strategy, chosen, tables, seconds)
        if is_policy(strategy):
            raise MeshError(
                f"policy {strategy} made no touch of {self.key}: it stopped before the first, or the "
                "sensor can't reach its locations."
            )
        raise MeshError(
            f"No viewpoint sees a location of {self.key} that the sensor can reach: the object is thinner "
            "than a pixel, or too narrow for the sensor. Try a larger rendering.resolution or strategy random."
        )

    def _exploration(
        self,
        strategy: str,
        parameters: ExperimentParameters,
        tables: Mapping[str, pa.Table],
        seconds: Mapping[str, float],
    ) -> Exploration:
        """Return the exploration of this object, with the time of its preparation."""
        seconds = {"prepare": self.seconds, **seconds}
        return Exploration(
            self.key, self.surface, parameters, strategy, seconds, tables, self.frame
        )

    def _with_real_size(self, values: Parameters | None) -> ExperimentParameters:
        """Set `scene.object_radius_m` from the file's unit if the unit is known and `values` does not set it."""
        parameters = as_parameters(values)
        scene = parameters.scene
        if self.frame.radius_m is None or "object_radius_m" in scene.model_fields_set:
            return parameters
        size = {"object_radius_m": self.frame.radius_m}
        return _with_values(parameters, "the object's size", scene=size)


@dataclass(frozen=True, eq=False)
class Exploration:
    """The views, touches and features of one object. Explorations are compared by identity.

    Attributes
    ----------
    key : str
        `class/name` of the object.
    surface : Surface
        The object's mesh in the object frame.
    parameters : ExperimentParameters
        Parameters of the views, touches and features.
    strategy : str
        Strategy or policy that chose the probing locations; ``given`` for points of the caller.
    seconds : mapping of str to float
        Wall time of each phase (s): ``prepare``, ``look``, ``touch`` and ``describe``. A policy's time is
        ``choose``. Touches at given points have no ``look``.
    tables : mapping of str to pyarrow.Table
        Tables ``views``, ``fixations``, ``touches``, ``effects`` and ``features``, in the object frame and in
        object radii. Each is also an attribute. ``frame.table(touches)`` converts a table to the frame of the
        mesh file. The command ``visuohaptic tables`` lists the columns.
    frame : FileFrame
        Transformation between the frame of the mesh file and the object frame; by default the identity.
    """

    key: str
    surface: Surface
    parameters: ExperimentParameters
    strategy: str
    seconds: Mapping[str, float]
    tables: Mapping[str, pa.Table]
    frame: FileFrame = field(default_factory=lambda: FileFrame(np.eye(4)))

    def __repr__(self) -> str:
        return f"<Exploration of {self.key}: {self._summary}, {sum(self.seconds.values()):.2f} s>"

    def _repr_html_(self) -> str:
        picture = draw_first_view(self.surface, self.parameters, self.views, self.touches)
        return picture_with_line(
            small_png_of(picture), f"{self.key}: {self._summary}; show() turns it"
        )

    @property
    def _summary(self) -> str:
        """The number of touches, and how they were chosen."""
        touches = self.touches.num_rows
        if not self.views.num_rows:
            return f"{touches} touches at given points"
        return f"{touches} touches from {self.views.num_rows} viewpoints by {self.strategy}"

    @property
    def views(self) -> pa.Table:
        """Views with eye position and saliency: one row per viewpoint, none for touches at given points."""
        return self.tables["views"]

    @property
    def fixations(self) -> pa.Table:
        """Probing locations, in order per viewpoint, with spare locations and locations out of reach; one row each."""
        return self.tables["fixations"]

    @property
    def touches(self) -> pa.Table:
        """Touches with imprint, point, normal and sensor size, one row each."""
        return self.tables["touches"]

    @property
    def effects(self) -> pa.Table:
        """Effects of view and touch: why each was needed or not, how often it ran, and its processor seconds."""
        return self.tables["effects"]

    @property
    def features(self) -> pa.Table:
        """Features of the touches, one row per row of `touches`, in the same order."""
        return self.tables["features"]

    @property
    def imprints(self) -> NDArray[np.float32]:
        """Imprints of the n touches, shape (n, r, r) or (n, taxels), float32, in the order of `touches`.

        Values are in [0, 1]: by default 1 is the nearest point of each imprint and 0 the farthest. With
        `sensor.normalisation` ``absolute``, 1 is contact and 0 is out of the sensor's depth range. r is
        `sensor.resolution`; imprints of other layouts than the square have one number per taxel.
        """
        return readings(self.touches).reshape(-1, *self.parameters.sensor.taxels.shape)

    @property
    def poses(self) -> FloatArray:
        """Poses of the n touches in the frame of the mesh file, shape (n, 4, 4), float64, from `FileFrame.poses`.

        Raises `MeshError` if `frame.has_way_back` is false.
        """
        return self.frame.poses(self.touches)

    def touch_next(
        self, point: ArrayLike, normal: ArrayLike | None = None
    ) -> tuple[Exploration, FeltTouch]:
        """Return a new exploration with one more touch at a given point, after ``touch(at=...)``.

        Touches, features and probing locations equal those of ``touch(at=...)`` with all points. If the sensor can't
        reach the point, it is set down as near as it can, and ``felt.acquired`` is False.

        Parameters
        ----------
        point : array_like of shape (3,)
            Point to touch, object frame. The touch is at the nearest point of the surface, which must be within
            0.1 object radii.
        normal : array_like of shape (3,), optional
            Outward direction of the sensor, object frame, of any length above 0. By default the outward normal
            of the surface.

        Returns
        -------
        exploration : Exploration
            The earlier touches and the new touch, which is the last row.
        felt : FeltTouch
            The new touch: its imprint, its features, and whether the sensor could reach the point.

        Raises
        ------
        ParameterError
            If a strategy chose the earlier touches, or `point` or `normal` is not allowed.

        Examples
        --------
        >>> import visuohaptic as vh
        >>> exploration = vh.example("chair").touch(at=[[0.1, -0.1, 0.4]])
        >>> exploration, felt = exploration.touch_next([-0.2, 0.3, -0.2])
        >>> exploration.touches.num_rows, felt.imprint.shape
        (2, (32, 32))
        """
        if self.strategy != GIVEN:
            raise ParameterError(
                f"The object was touched by strategy {self.strategy}; touch_next needs touches by touch(at=...)."
            )
        (tables, seconds), felt = touch_next_point(
            self.key, self.surface, point, normal, self.parameters, dict(self.tables)
        )
        sums = {name: self.seconds.get(name, 0.0) + part for name, part in seconds.items()}
        exploration = replace(self, tables=tables, seconds={**self.seconds, **sums})
        return exploration, felt

    def recognise(self, model: str | Path | Recogniser | None = None) -> Recognition:
        """Classify the object from its touches, by any strategy or at given points.

        Parameters
        ----------
        model : path or Recogniser, optional
            A fitted model or its ``.skops`` file; by default the file of `recognising.default_model`.

        Returns
        -------
        Recognition
            The likeliest class, the class probabilities, the prediction set and the novelty rank. If the model did
            not learn from touches by this strategy, prediction set and novelty rank are None, and
            `Recognition.caution` says why. If the model uses the azimuth, the touches are also classified after
            quarter turns about the vertical.

        Raises
        ------
        RecognitionError
            If the model is missing or learnt from touches with other parameters, the model can't use these
            touches, or the sensor could reach none of the given points.
        """
        recogniser = model if isinstance(model, Recogniser) else read_recogniser(model)
        check_compatible(self.parameters, recogniser)
        if self.strategy == GIVEN:
            check_acquired(self.features, self.parameters)
        started = time.perf_counter()
        answer = recogniser.model.answer(self.features)
        turned = classes_when_turned(recogniser.model, self.features)
        seconds = {**self.seconds, "recognise": time.perf_counter() - started}
        likeliest = next(iter(answer.probabilities))
        notes = (note_on_few_objects(answer), note_on_front(likeliest, turned))
        return Recognition(
            UNKNOWN if answer.unknown else likeliest,
            answer.probabilities,
            self,
            self.features.num_rows,
            seconds,
            answer.candidates,
            answer.novelty_rank,
            answer.unknown,
            answer.coverage,
            caution_about(self.strategy, recogniser),
            answer.compared,
            turned,
            tuple(note for note in notes if note is not None),
        )

    def show(self, path: str | Path | None = None) -> Path | None:
        """Show the object with its touches as a model that can be turned, in a notebook or in the browser.

        The model has the touches of a viewpoint, numbered in order, and the squares of the sensor on the surface. The
        reader chooses the viewpoint, and sees the imprint of a number.

        `path`, the result and the errors are as in `TouchableObject.show`.
        """
        figure = exploration_figure(
            self.key, self.surface, self.parameters, self.strategy, self.views, self.touches
        )
        return show_figure(figure, f"{self._summary}.", path)

    def picture(self) -> Image:
        """Draw all views with their numbered touches and the squares of the sensor, and all imprints.

        Returns
        -------
        PIL.Image.Image
        """
        return draw_exploration(self.surface, self.parameters, self.views, self.touches)

    def save(self, folder: str | Path) -> list[Path]:
        """Write the tables as Parquet, the poses of the touches as CSV, and the picture as PNG.

        The files are ``<table>.parquet`` per table, ``poses.csv`` in the frame of the mesh file, and ``picture.png``.
        ``poses.csv`` is left out if `frame.has_way_back` is false.

        Parameters
        ----------
        folder : path
            Folder of the files; created if missing. Files of the same names are replaced, so use one folder per
            object. No file changes before all are written.

        Returns
        -------
        list of pathlib.Path
        """
        folder = Path(folder)
        poses = ["poses.csv"] if self.frame.has_way_back else []
        names = [*(f"{name}.parquet" for name in SCHEMAS), *poses, "picture.png"]
        existing = next(path for path in (folder, *folder.absolute().parents) if path.is_dir())
        with unfinished_folder(existing) as unfinished:
            for name, schema in SCHEMAS.items():
                write_table(schema, self.tables[name], unfinished / f"{name}.parquet")
            for name in poses:
                write_poses(self.poses, unfinished / name)
            self.picture().save(unfinished / "picture.png")
            folder.mkdir(parents=True, exist_ok=True)
            for name in names:
                (unfinished / name).replace(folder / name)
        return [folder / name for name in names]


@dataclass(frozen=True, eq=False)
class Recognition:
    """The class that a model predicts for an object. Recognitions are compared by identity.

    Attributes
    ----------
    name : str
        The likeliest class, or ``unknown`` if `unknown` is True.
    probabilities : mapping of str to float
        Probability of every class of the model, the likeliest class first.
    exploration : Exploration
        The exploration with the touches.
    touches : int
        Number of touches of `exploration`.
    seconds : mapping of str to float
        Wall time of each phase (s): `Exploration.seconds`, and ``recognise``.
    candidates : tuple of str or None
        The prediction set: classes that the object may have, the likeliest first. It holds the likeliest class.
        Of objects like the training objects, at least the share `coverage` have their class in their set; the
        share is measured (docs/certainty.md). None if the model is not calibrated for the strategy of the
        touches; then `novelty_rank`, `unknown`, `coverage` and `compared` are None, too.
    novelty_rank : float or None
        k / (n + 1), in [0, 1): k of the n held-out training objects have a lower novelty score than this
        object.
    unknown : bool or None
        Whether `novelty_rank` is `coverage` or more, so that the object seems to be of no class of the model. Also
        None if the model learnt too few objects to say so (29 are needed for a coverage of 0.9).
    coverage : float or None
        Stated coverage of `candidates` and `unknown`: parameter `recognition.order_free.coverage` of the model.
    caution : str or None
        A warning with the strategies of the training touches and the strategy of these touches, if the model did
        not learn from the latter; otherwise None.
    compared : int or None
        The number n of training objects with which `novelty_rank` compares.
    turned : mapping of int to str
        The likeliest class if the touches are turned by 90, 180 or 270 degrees about the vertical, from +z towards
        +x. Empty if the model does not use the azimuth (`recognition.frame`).
    notes : tuple of str
        Sentences about the answer: the model learnt too few objects to call an object unknown, or the likeliest
        class changes under quarter turns.
    """

    name: str
    probabilities: Mapping[str, float]
    exploration: Exploration
    touches: int
    seconds: Mapping[str, float]
    candidates: tuple[str, ...] | None = None
    novelty_rank: float | None = None
    unknown: bool | None = None
    coverage: float | None = None
    caution: str | None = None
    compared: int | None = None
    turned: Mapping[int, str] = field(default_factory=dict)
    notes: tuple[str, ...] = ()

    def __repr__(self) -> str:
        line = probability_line(self.probabilities)
        if self.unknown:
            line = f"{UNKNOWN} ({line})"
        touches = f"from {self.touches} touches"
        said = "; ".join(part for part in (line, self._set_phrase(), touches) if part is not None)
        if self._sentences():
            said = " ".join((f"{said}.", *self._sentences()))
        return f"<Recognition of {self.exploration.key}: {said}>"

    def _repr_html_(self) -> str:
        key = self.exploration.key
        named = f"{key}: {UNKNOWN}" if self.unknown else key
        phrase = self._set_phrase()
        said = () if phrase is None else (phrase,)
        return probability_table(
            named, self.probabilities, self.touches, (*said, *self._sentences())
        )

    def _set_phrase(self) -> str | None:
        """Return the prediction set in words; None for an unknown object, or without a set."""
        return None if self.unknown else set_phrase(self.candidates, self.coverage)

    def _sentences(self) -> tuple[str, ...]:
        return self.notes if self.caution is None else (self.caution, *self.notes)


def load(
    source: Source,
    key: str | None = None,
    parameters: MeshParameters | Parameters | None = None,
    file_type: str | None = None,
    unit: str | None = None,
    *,
    up: str | None = None,
    front: str | None = None,
) -> TouchableObject:
    """Read a mesh and transform it to the object frame.

    Parameters
    ----------
    source : path, binary file, trimesh.Trimesh or Scene, open3d TriangleMesh, pyvista.PolyData, (vertices, faces) or Surface
        A mesh file; an open file; a mesh in memory; or two arrays, shapes (v, 3) and (f, 3). A packed model of
        the repository, ``meshes/<set>/<class>/<name>.ply.gz``, is rotated and scaled per axis as
        ``meshes/catalogue.csv`` says.
    key : str, optional
        `class/name`, from which random numbers are seeded together with parameter `seed`. By default the name
        is the file's, or ``object`` without a file. The class is ``unknown``, or for a packed model its folder.
    parameters : MeshParameters, ExperimentParameters or mapping, optional
        Parameters of section `meshes`, such as the largest size of a file. A mapping has names of this section, or
        sections with their parameters.
    file_type : str, optional
        Format of an open file, such as ``obj``; by default the suffix of its name.
    unit : {"mm", "cm", "m", "in"}, optional
        Unit of length of the source, from which `touch` sets `scene.object_radius_m` unless its parameters do.
        By default the unit is not known, and the parameter keeps its value.
    up : {"x", "-x", "y", "-y", "z", "-z", "file", "auto"}, optional
        Axis of the source that points up; by default parameter `own_up_axis`: as the file says, else y. ``auto``
        takes y or z, the axis on which the object stands more steadily.
    front : {"x", "-x", "y", "-y", "z", "-z"}, optional
        Axis of the source that points to the front, perpendicular to the up axis; by default parameter
        `own_front_axis`: z, for up axis z it is -y, and for -z it is y.

    Returns
    -------
    TouchableObject

    Raises
    ------
    MeshError
        If the source can't be read or has no surface, `key` is not `class/name`, `unit` is not one of the four
        units, or the up axis that the file states is parallel to `front`.
    ParameterError
        If a parameter or axis is not allowed, the axes are parallel, or an axis is given for a packed model.

    Warns
    -----
    MeshWarning
        If a file that the source refers to is missing, or y is probably not the axis that points up. The
        sentences are also in ``surface.notes``.
    """
    started = time.perf_counter()
    if key is not None and (key.count("/") != 1 or not all(key.split("/"))):
        raise MeshError(f"{key!r} is no key of an object; 'class/name' is allowed.")
    chosen = with_axes(mesh_parameters(parameters), source, up, front)
    model = model_of(source)
    surface, from_file = prepare_object(model, source, chosen, file_type, UP_ADVICE)
    for note in surface.notes:
        warnings.warn(note, MeshWarning, stacklevel=2)
    seconds = time.perf_counter() - started
    frame = FileFrame(from_file, unit)
    return TouchableObject(model.key if key is None else key, surface, seconds, frame)


def touch(
    sources: Source | TouchableObject | Iterable[Source | TouchableObject],
    viewpoints: int | None = None,
    strategy: str = "fixation",
    parameters: Parameters | None = None,
    track: Callable[[Sequence[TouchableObject]], Iterable[TouchableObject]] | None = None,
) -> list[Exploration]:
    """Load several objects, then touch each by `TouchableObject.touch`.

    Parameters
    ----------
    sources : iterable
        Objects, or sources as `load` takes them. A single object or source needs no list.
    viewpoints, strategy, parameters
        As in `TouchableObject.touch`; the same for all objects. Section `meshes` is also used by `load`.
    track : callable, optional
        Takes the sequence of objects and yields each object; by default a progress bar.

    Returns
    -------
    list of Exploration
        One exploration per object, in the order of `sources`.

    Raises
    ------
    MeshError
        If an object can't be read, before any is touched; or if an object has no touch. The explorations of
        earlier objects are lost then.
    ParameterError
        If a parameter or the strategy is not allowed.
    """
    chosen = as_parameters(parameters)
    several: Any = [sources] if is_one_source(sources) else sources
    objects = [
        source if isinstance(source, TouchableObject) else load(source, parameters=chosen)
        for source in several
    ]
    if track is None:
        # Work of less than a second needs no progress bar.
        track = partial(tqdm, desc="touching", unit="object", delay=1, leave=False)
    return [item.touch(viewpoints, strategy, chosen) for item in track(objects)]


def _with_values(
    parameters: ExperimentParameters, source: str, **sections: dict[str, Any]
) -> ExperimentParameters:
    """Return parameters with new values in some sections. Errors name `source` as the origin of the values."""
    # Other code asks which parameters were set, so that parameters at their defaults stay unset.
    values = parameters.model_dump(exclude_unset=True)
    for name, new_values in sections.items():
        values[name] = {**values.get(name, {}), **new_values}
    return ExperimentParameters.from_mapping(values, source, _ARGUMENTS)
