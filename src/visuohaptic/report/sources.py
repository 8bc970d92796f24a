"""From the page's figures back to the tables: files, rows and columns that each part is made of."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from visuohaptic.report.run import Run
from visuohaptic.studies.declared import PACKAGED

Paths = Sequence[str | Path]

_SHARE = "share of rows with predicted = class, averaged over splits"
_NAMED = ("class", "predicted", "split")


@dataclass(frozen=True)
class Source:
    """What a part of a section is made of.

    Attributes
    ----------
    what : str
        The part: a table, a chart or a sentence.
    file : str
        Parquet file, or pattern of such files, relative to the run's folder.
    table : str
        Name of its schema.
    columns : tuple of str
        Columns that hold the figures.
    by : tuple of str
        Columns that tell the page's rows apart.
    rows : mapping of str to str or int
        Value of each column that selects rows.
    """

    what: str
    file: str
    table: str
    columns: tuple[str, ...]
    by: tuple[str, ...] = ()
    rows: Mapping[str, str | int] = field(default_factory=dict)

    @property
    def filter(self) -> str:
        """The selected rows in words, such as `classifier = naive_bayes`; empty for all."""
        return ", ".join(f"{column} = {value}" for column, value in self.rows.items())


def find_sources(run: Run, shown: tuple[str, int]) -> dict[str, list[Source]]:
    """Give the tables behind each section.

    Parameters
    ----------
    run : Run
        The run.
    shown : tuple of str and int
        Object, `class/name`, and viewpoint that explain the method.

    Returns
    -------
    dict of str to list of Source
        By the section's name. A section whose figures come from no table is left out.
    """
    found = {
        "answer": [*_answer(run), *_cost(run), *_stability(run), *_influence(run)],
        "comparison": [*_accuracy(run), *_votes(run)],
        "touches_needed": list(_touches_needed(run)),
        "confusion": [_confusion(run)] if run.pipelines else [],
        "certainty": list(_certainty(run)),
        "looking": list(_looking(run)),
        "cost": list(_cost(run)),
        "gaze": list(_gaze(run)),
        "readings": list(_readings(run)),
        "influence": [*_influence(run), *_study(run, "effects"), _places(run, shown)],
        "effects": list(_effects(run)),
        "guards": list(
            _extra(run, "guards", "The guards", "guards", ("outcome", "found"), ("guard",))
        ),
        "stability": list(_stability(run)),
        "ablations": list(_study(run, "ablations")),
        "studies": list(_own_studies(run)),
        "method": [_one_view(run, shown), _first_touch(run, shown)],
        "objects": list(_objects(run)),
    }
    return {section: sources for section, sources in found.items() if sources}


def _accuracy(run: Run) -> list[Source]:
    return [
        Source(
            f"Accuracy, pipeline {table.name}: {_SHARE}",
            _of_pipeline(run, table.name),
            "predictions",
            _NAMED,
            ("strategy", "classifier"),
            {"pipeline": table.name},
        )
        for table in run.pipelines
    ]


def _answer(run: Run) -> list[Source]:
    return [
        Source(
            f"The best classifier: {_SHARE}",
            _of_pipeline(run, table.name),
            "predictions",
            _NAMED,
            ("strategy",),
            {"pipeline": table.name, "classifier": table.best.key},
        )
        for table in run.pipelines
    ]


def _votes(run: Run) -> Iterator[Source]:
    for table in run.pipelines:
        yield Source(
            f"Whole objects, pipeline {table.name}: voted, or the majority of predicted where it is missing",
            _of_pipeline(run, table.name),
            "predictions",
            ("class", "object", "predicted", "voted", "split"),
            ("strategy", "classifier"),
            {"pipeline": table.name},
        )


def _confusion(run: Run) -> Source:
    table = run.pipelines[0]
    return Source(
        "Number of rows",
        _of_pipeline(run, table.name),
        "predictions",
        ("class", "predicted"),
        ("strategy", "class", "predicted"),
        {"pipeline": table.name, "classifier": table.best.key},
    )


def _touches_needed(run: Run) -> Iterator[Source]:
    yield from _extra(
        run,
        "touches_needed",
        "Area and touches needed",
        "touches_needed",
        ("area", "touches", "gain", "p_value"),
        ("pipeline", "strategy"),
    )
    yield from _study(run, "curves")


def _certainty(run: Run) -> Iterator[Source]:
    columns = ("correct", "covered", "covered_at", "candidates", "strangeness", "unknown")
    by = ("strategy", "views", "known", "left_out")
    yield from _extra(run, "certainty", "Known and unknown objects", "certainty", columns, by)
    new = ("correct", "covered", "candidates", "unknown")
    yield from _extra(
        run, "evaluation", "Objects not learnt", "evaluation", new, ("strategy", "views", "known")
    )


def _cost(run: Run) -> Iterator[Source]:
    columns = (
        *("seconds", "seconds_low", "seconds_high", "error", "error_low", "error_high"),
        *("seconds_render", "seconds_attend", "seconds_cast"),
    )
    for name, what in (("frontier", "Settings of this run"), ("cost", "The whole study")):
        yield from _extra(run, name, what, "cost", columns, ("family", "setting"))


def _looking(run: Run) -> Iterator[Source]:
    columns, by = ("accuracy", "seconds", "gaps"), ("sight", "answer", "strategy", "touches")
    yield from _extra(run, "looking", "Looking, touching and both", "looking", columns, by)


def _readings(run: Run) -> Iterator[Source]:
    columns = ("fixation", "random", "ahead", "p_value")
    by = ("reading", "classifier")
    yield from _extra(run, "readings", "Readings of the paper", "readings", columns, by)


def _gaze(run: Run) -> Iterator[Source]:
    columns = ("correlation", "auc_top", "auc_gaze", "normalised_saliency")
    yield from _extra(
        run, "gaze", "Predictions against people", "gaze", columns, ("object", "predictor")
    )
    shown = ("rank", "correlation", "picture")
    yield from _extra(run, "gaze_pictures", "Pictures", "gaze_pictures", shown, ("object",))


def _stability(run: Run) -> Iterator[Source]:
    columns, by = ("cases", "worst_error", "tolerance"), ("family", "requirement")
    yield from _extra(run, "stability", "Each object's numbers", "stability", columns, by)


def _influence(run: Run) -> Iterator[Source]:
    columns = ("touches", "called_for", "seconds", "seconds_always", "image_shift")
    what = "Run time of effects and changes of images"
    yield from _extra(
        run, "effect_influence", what, "effect_influence", columns, ("scene", "effect")
    )


def _effects(run: Run) -> Iterator[Source]:
    if run.files.effects:
        columns = ("mode", "reason", "touches", "runs", "seconds")
        file = _pattern(run, run.files.effects)
        yield Source("Effects", file, "effects", columns, ("effect",))
    file = _pattern(run, run.files.views)
    yield Source("Channels of attention", file, "views", ("conspicuity", "skipped"))


def _study(run: Run, study: str) -> Iterator[Source]:
    folder = run.files.extras.get("studies")
    file = None if folder is None else Path(folder) / f"{study}.parquet"
    if file is not None and file.is_file():
        columns = ("accuracy", "low", "high", "difference", "adjusted_p")
        by = ("pipeline", "strategy", "classifier", "condition")
        yield Source(f"Study {study}", _pattern(run, [file]), "study_figures", columns, by)


def _own_studies(run: Run) -> Iterator[Source]:
    folder = run.files.extras.get("studies")
    files = [] if folder is None else sorted(Path(folder).glob("*.parquet"))
    for file in files:
        if file.stem not in PACKAGED:
            yield from _study(run, file.stem)


def _one_view(run: Run, shown: tuple[str, int]) -> Source:
    columns = ("image", "sensor_size", "contact_state")
    return Source(
        "The touches shown",
        _of_object(run, run.files.touches, shown[0]),
        "touches",
        columns,
        ("touch",),
        _rows_of_view(shown),
    )


def _places(run: Run, shown: tuple[str, int]) -> Source:
    return Source(
        "Places touched in each scene",
        _of_object(run, run.files.touches, shown[0]),
        "touches",
        ("x", "y", "z", "normal_x", "normal_y", "normal_z"),
        ("touch",),
        _rows_of_view(shown),
    )


def _first_touch(run: Run, shown: tuple[str, int]) -> Source:
    return Source(
        "Contourlet deviations, 01 to 16",
        _of_object(run, run.files.features, shown[0]),
        "features",
        ("contourlet_01", "contourlet_16"),
        (),
        {**_rows_of_view(shown), "touch": 0},
    )


def _objects(run: Run) -> Iterator[Source]:
    view = ("class", "object", "viewpoint")
    yield Source(
        "Views and maps",
        _pattern(run, run.files.views),
        "views",
        ("view", "saliency", "conspicuity"),
        view,
    )
    yield Source(
        "Fixations, the touched ones by the touches' rank",
        _pattern(run, run.files.fixations),
        "fixations",
        ("pixel_row", "pixel_column"),
        (*view, "touch"),
        {"strategy": "fixation"},
    )
    yield Source(
        "Imprints, sizes and contact states",
        _pattern(run, run.files.touches),
        "touches",
        ("image", "sensor_size", "contact_state"),
        (*view, "strategy", "touch"),
    )
    for table in run.pipelines[:1]:
        yield Source(
            "Classes predicted",
            _of_pipeline(run, table.name),
            "predictions",
            ("predicted",),
            ("class", "object", "strategy"),
            {"pipeline": table.name, "classifier": table.best.key},
        )


def _extra(
    run: Run, name: str, what: str, table: str, columns: tuple[str, ...], by: tuple[str, ...]
) -> Iterator[Source]:
    """Give the source that not every run has, where this one does."""
    path = None if name not in run.files.extras else Path(run.files.extras[name])
    files = sorted(path.rglob("*.parquet")) if path is not None and path.is_dir() else [path]
    if path is not None and path.exists() and files:
        yield Source(what, _pattern(run, [file for file in files if file]), table, columns, by)


def _rows_of_view(shown: tuple[str, int]) -> dict[str, str | int]:
    category, _, name = shown[0].partition("/")
    return {"class": category, "object": name, "viewpoint": shown[1], "strategy": "fixation"}


def _of_pipeline(run: Run, pipeline: str) -> str:
    files = [file for file in run.files.predictions if Path(file).parent.name == pipeline]
    return _pattern(run, files or run.files.predictions)


def _of_object(run: Run, files: Paths, key: str) -> str:
    own = [file for file in files if Path(file).parent.as_posix().endswith(f"/{key}")]
    return _pattern(run, own or files)


def _pattern(run: Run, files: Paths) -> str:
    """Name files as one path or pattern, relative to the run's folder."""
    relative = [Path(os.path.relpath(file, run.files.folder)) for file in files]
    if len(relative) == 1:
        return relative[0].as_posix()
    folder = Path(os.path.commonpath([file.parent for file in relative]))
    deep = any(file.parent != folder for file in relative)
    return (folder / ("**/*.parquet" if deep else "*.parquet")).as_posix()
