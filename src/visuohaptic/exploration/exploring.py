"""One object from its mesh file to its name, without the workflow and with the same results."""

from __future__ import annotations

import tempfile
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pyarrow as pa
from pydantic import BaseModel

from visuohaptic.errors import MeshError, RecognitionError
from visuohaptic.geometry.surface import Surface, write_surface
from visuohaptic.meshes.catalogue import Model, read_catalogue
from visuohaptic.meshes.parameters import MeshParameters
from visuohaptic.meshes.preparing import prepare_object
from visuohaptic.parameters import ExperimentParameters, check_parameters, read_parameters
from visuohaptic.tables.phases import (
    EFFECTS,
    FEATURES,
    FIXATIONS,
    TOUCHES,
    VIEWS,
)
from visuohaptic.tables.schema import read_table, write_table

if TYPE_CHECKING:
    from PIL.Image import Image

    from visuohaptic.recognition.model import RecognitionModel

DEFAULT_MODEL = Path("results/models/best.skops")
"""Where the workflow leaves its recognition model."""

UNKNOWN_CLASS = "unknown"
VIEWPOINTS_AT_ONCE = 8
"""Viewpoints that are worked on together; it changes no result."""

_SCHEMAS = {schema.name: schema for schema in (VIEWS, FIXATIONS, TOUCHES, EFFECTS, FEATURES)}
_TOUCHING_SECTIONS = ("viewpoints", "rendering", "attention", "sensor", "scene", "features")
_FREE = ("viewpoints.count", "attention.fixations")

Steps = Sequence[Callable[[], None]]
Track = Callable[[Steps], Iterable[Callable[[], None]]]


@dataclass(frozen=True)
class TouchableObject:
    """An object made ready for the eye and the hand.

    Attributes
    ----------
    key : str
        `class/name`; the class is ``unknown`` where nobody told it.
    surface : Surface
        In the object frame.
    seconds : float
        What reading and preparing it took.
    """

    key: str
    surface: Surface
    seconds: float

    def touch(
        self,
        viewpoints: int | None = None,
        strategy: str = "fixation",
        parameters: ExperimentParameters | None = None,
        track: Track = iter,
    ) -> Exploration:
        """Look at the object from all around, and set the sensor down on it.

        Parameters
        ----------
        viewpoints : int, optional
            Viewpoints on each ring; without it as `parameters` say.
        strategy : str
            How the probing locations are chosen.
        parameters : ExperimentParameters, optional
            Everything else; without it the defaults, which are those of the paper.
        track : callable
            Takes the steps of the work and gives them back one by one, as a progress
            bar such as ``tqdm.tqdm`` does.

        Returns
        -------
        Exploration
            What was seen and felt; the same as the workflow finds for the same key.

        Raises
        ------
        ParameterError
            If the number of viewpoints or the strategy is not allowed.
        """
        chosen = _with_choices(parameters or ExperimentParameters(), viewpoints, strategy)
        with tempfile.TemporaryDirectory(prefix="visuohaptic-") as folder:
            work = _Work(self.key, Path(folder), chosen, {})
            write_surface(self.surface, work.mesh)
            for step in track(work.steps()):
                step()
            tables = {
                name: read_table(schema, work.files(name)) for name, schema in _SCHEMAS.items()
            }
        seconds = {"prepare": self.seconds, **work.seconds}
        return Exploration(self.key, self.surface, chosen, strategy, seconds, **tables)


@dataclass(frozen=True)
class Exploration:
    """What the eye saw of an object, and what the hand felt.

    Attributes
    ----------
    key : str
        `class/name` of the object.
    surface : Surface
        The object.
    parameters : ExperimentParameters
        How it was explored.
    strategy : str
        How the probing locations were chosen.
    seconds : mapping of str to float
        What each phase took: prepare, look, touch, describe.
    views, fixations, touches, effects, features : pyarrow.Table
        As `visuohaptic.tables.schema` describes them.
    """

    key: str
    surface: Surface
    parameters: ExperimentParameters
    strategy: str
    seconds: Mapping[str, float]
    views: pa.Table
    fixations: pa.Table
    touches: pa.Table
    effects: pa.Table
    features: pa.Table

    def recognise(self, model: str | Path | Recogniser = DEFAULT_MODEL) -> Recognition:
        """Name the object from its touches.

        Parameters
        ----------
        model : path or Recogniser
            A fitted model, or where one lies.

        Returns
        -------
        Recognition
            The likeliest class, and how likely each is.

        Raises
        ------
        RecognitionError
            If there is no such model, or it learnt from touches that were made in another way.
        """
        recogniser = model if isinstance(model, Recogniser) else read_recogniser(model)
        _check_alike(self, recogniser)
        started = time.perf_counter()
        probabilities = recogniser.model.recognise(self.features)
        seconds = {**self.seconds, "name": time.perf_counter() - started}
        used = recogniser.model.touches * self.views.num_rows
        return Recognition(next(iter(probabilities)), probabilities, self, used, seconds)

    def picture(self) -> Image:
        """Draw the views with the numbered touches and the sensor's squares, and the imprints.

        Returns
        -------
        PIL.Image.Image
            The picture.
        """
        from visuohaptic.exploration.picture import draw_exploration

        return draw_exploration(self.surface, self.parameters, self.views, self.touches)

    def save(self, folder: str | Path) -> list[Path]:
        """Write every table and the picture.

        Parameters
        ----------
        folder : path
            Where to; made where missing. The names of the files do not depend on the object.

        Returns
        -------
        list of pathlib.Path
            The files.
        """
        folder = Path(folder)
        folder.mkdir(parents=True, exist_ok=True)
        files = []
        for name, schema in _SCHEMAS.items():
            files.append(folder / f"{name}.parquet")
            write_table(schema, getattr(self, name), files[-1])
        files.append(folder / "picture.png")
        self.picture().save(files[-1])
        return files


@dataclass(frozen=True)
class Recognition:
    """What an object was named.

    Attributes
    ----------
    name : str
        The likeliest class.
    probabilities : mapping of str to float
        Of every class that the model knows, the likeliest first.
    exploration : Exploration
        What the answer rests on.
    touches : int
        Touches that the answer rests on.
    seconds : mapping of str to float
        What each phase took: prepare, look, touch, describe, name.
    """

    name: str
    probabilities: Mapping[str, float]
    exploration: Exploration
    touches: int
    seconds: Mapping[str, float]


@dataclass(frozen=True)
class Recogniser:
    """A recognition model, and how the touches were made from which it learnt."""

    model: RecognitionModel
    parameters: ExperimentParameters


def load(
    path: str | Path, key: str | None = None, parameters: MeshParameters | None = None
) -> TouchableObject:
    """Read a mesh file and make it ready.

    Parameters
    ----------
    path : path
        An OBJ, PLY, STL, GLB or OFF file, or a packed model of the repository
        (``meshes/paper/<class>/<name>.ply.gz``), which is turned and stretched as
        the catalogue above it says.
    key : str, optional
        `class/name`; all chance comes from it and the seed. Without it the class is
        ``unknown``, or the catalogue's.
    parameters : MeshParameters, optional
        Which axis points up, and tolerances.

    Returns
    -------
    TouchableObject
        The object.

    Raises
    ------
    MeshError
        If the file can't be read or has nothing to touch, or the key is no `class/name`.
    """
    started = time.perf_counter()
    path = Path(path)
    model = _catalogued(path)
    if model is None:
        # A file's name may hold bytes that are no text, which no table can hold.
        name = path.name.removesuffix(".gz").rpartition(".")[0] or path.name
        model = Model(UNKNOWN_CLASS, name.encode("utf-8", "replace").decode("utf-8"))
    surface = prepare_object(model, path, parameters or MeshParameters())
    key = model.key if key is None else key
    if key.count("/") != 1:
        raise MeshError(f"{key!r} is no key of an object; 'class/name' is allowed.")
    return TouchableObject(key, surface, time.perf_counter() - started)


def read_recogniser(path: str | Path = DEFAULT_MODEL) -> Recogniser:
    """Read a recognition model and the parameters beside it.

    Parameters
    ----------
    path : path
        The ``.skops`` file; a ``.yaml`` file of the same name tells how its touches were made.

    Returns
    -------
    Recogniser
        The model and its parameters.

    Raises
    ------
    RecognitionError
        If one of the two is missing, or the model can't be read safely.
    """
    from visuohaptic.recognition.model import load_model

    path = Path(path)
    for file in (path, path.with_suffix(".yaml")):
        if not file.is_file():
            raise RecognitionError(
                f"{file} is not there, and recognition needs it; `snakemake -j2 model_all` fits a "
                f"model and writes {DEFAULT_MODEL} with its parameters beside it."
            )
    return Recogniser(load_model(path), read_parameters(path.with_suffix(".yaml")))


@dataclass(frozen=True)
class _Work:
    """The steps from a mesh to features, file to file, a block of viewpoints each."""

    key: str
    folder: Path
    parameters: ExperimentParameters
    seconds: dict[str, float]

    @property
    def mesh(self) -> Path:
        return self.folder / "mesh.ply"

    @property
    def blocks(self) -> list[range]:
        total = self.parameters.viewpoints.total
        starts = range(0, total, VIEWPOINTS_AT_ONCE)
        return [range(start, min(start + VIEWPOINTS_AT_ONCE, total)) for start in starts]

    def file(self, table: str, block: Sequence[int]) -> Path:
        return self.folder / f"{table}-{block[0]}.parquet"

    def files(self, table: str) -> list[Path]:
        parts = ("effects_of_view", "effects") if table == "effects" else (table,)
        return [self.file(part, block) for part in parts for block in self.blocks]

    def steps(self) -> list[Callable[[], None]]:
        def step(phase: str, work: Callable[[range], None], block: range) -> Callable[[], None]:
            return lambda: self._timed(phase, work, block)

        phases = {"look": self._look, "touch": self._touch, "describe": self._describe}
        return [step(phase, work, block) for block in self.blocks for phase, work in phases.items()]

    def _timed(self, phase: str, work: Callable[[range], None], block: range) -> None:
        started = time.perf_counter()
        work(block)
        self.seconds[phase] = self.seconds.get(phase, 0.0) + time.perf_counter() - started

    def _look(self, block: range) -> None:
        from visuohaptic.fixations.files import make_fixations

        make_fixations(
            key=self.key,
            mesh=self.mesh,
            fixations=self.file("fixations", block),
            views=self.file("views", block),
            effects=self.file("effects_of_view", block),
            block=block,
            viewpoints=self.parameters.viewpoints,
            rendering=self.parameters.rendering,
            attention=self.parameters.attention,
            probing=self.parameters.probing,
            modes=self.parameters.scene.effects,
            seed=self.parameters.seed,
        )

    def _touch(self, block: range) -> None:
        from visuohaptic.touches.files import make_touches

        make_touches(
            mesh=self.mesh,
            fixations=self.file("fixations", block),
            touches=self.file("touches", block),
            effects=self.file("effects", block),
            sensor=self.parameters.sensor,
            scene=self.parameters.scene,
            seed=self.parameters.seed,
        )

    def _describe(self, block: range) -> None:
        from visuohaptic.features.files import make_features

        make_features(
            touches=self.file("touches", block),
            output=self.file("features", block),
            parameters=self.parameters.features,
        )


def _catalogued(path: Path) -> Model | None:
    """Find a packed model, `<folder>/<set>/<class>/<name>.ply.gz`, in `<folder>/catalogue.csv`."""
    folders = path.absolute().parents
    if not path.name.endswith(".ply.gz") or len(folders) < 3:
        return None
    catalogue = folders[2] / "catalogue.csv"
    if not catalogue.is_file():
        return None
    key = f"{folders[0].name}/{path.name.removesuffix('.ply.gz')}"
    return next((model for model in read_catalogue(catalogue) if model.key == key), None)


def _with_choices(
    parameters: ExperimentParameters, viewpoints: int | None, strategy: str
) -> ExperimentParameters:
    values = parameters.model_dump()
    values["probing"]["strategies"] = (strategy,)
    if viewpoints is not None:
        values["viewpoints"]["count"] = viewpoints
    return check_parameters(values, "touch")


def _check_alike(exploration: Exploration, recogniser: Recogniser) -> None:
    """Refuse touches that were made in another way than those that the model learnt from."""
    if exploration.strategy != recogniser.model.strategy:
        raise RecognitionError(
            f"The object was touched by {exploration.strategy} and the model learnt from touches by "
            f"{recogniser.model.strategy}; touch with strategy {recogniser.model.strategy!r}."
        )
    here, there = (
        _flat(parameters.model_dump(include=set(_TOUCHING_SECTIONS)))
        for parameters in (exploration.parameters, recogniser.parameters)
    )
    names = sorted(set(here) | set(there))
    unlike = [name for name in names if here.get(name) != there.get(name) and name not in _FREE]
    if unlike:
        found = ", ".join(
            f"{name} {here.get(name)} (the model's is {there.get(name)})" for name in unlike
        )
        raise RecognitionError(
            f"The object was touched with {found}; touch it with the parameters that lie "
            "beside the model."
        )


def _flat(values: Mapping[str, Any], above: str = "") -> dict[str, Any]:
    flat: dict[str, Any] = {}
    for name, value in values.items():
        value = value.model_dump() if isinstance(value, BaseModel) else value  # noqa: PLW2901
        inner = _flat(value, f"{above}{name}.") if isinstance(value, dict) else None
        flat |= {f"{above}{name}": value} if inner is None else inner
    return flat
