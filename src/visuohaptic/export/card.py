"""The data set's card: README.md with the header that `datasets` and the Hugging Face Hub read."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import pyarrow as pa
import yaml

from visuohaptic.export.columns import COLUMNS, IMAGE, IMPRINT, LITE_COLUMNS
from visuohaptic.export.contents import SPLITS, Contents
from visuohaptic.export.experiment import Experiment
from visuohaptic.tables.phases import FEATURES
from visuohaptic.tables.schema import Column

MARK = "<!-- written by `visuohaptic export` -->"
"""Stands in the card, so that a later export knows its own folder."""


@dataclass(frozen=True)
class Configuration:
    """One of the tables of the data set: its folder, its columns, and a file for each of its splits."""

    folder: str
    columns: Sequence[Column]
    splits: Sequence[str] = SPLITS

    @property
    def files(self) -> dict[str, str]:
        """The Parquet file of each split."""
        return {split: f"{self.folder}/{split}.parquet" for split in self.splits}


CONFIGURATIONS = {
    "default": Configuration("data", COLUMNS),
    "lite": Configuration("lite", LITE_COLUMNS),
    "features": Configuration("features", FEATURES.columns, ("run",)),
}
"""By the names that `datasets` takes."""

LIMITS = """- Touches are simulated: a rigid surface met along its normal by a flat sensor without noise, unless the
  parameters' scene says otherwise. No hand, no slip, no force.
- Objects are models of furniture and household things, most of them shells that are not watertight; a class
  has few of them, so the figures below have wide intervals.
- Objects of one author may resemble each other, and no split keeps authors apart."""

# Names of the Hub, as far as the catalogue needs them.
_KNOWN = ("CC0-1.0", "CC-BY-3.0", "CC-BY-4.0", "CC-BY-SA-3.0", "CC-BY-SA-4.0", "MIT")
_LICENCES = {name: name.lower() for name in _KNOWN} | {"CC-BY-3.0-US": "cc-by-3.0"}
CITATION = """The experiment follows G. Rouhafzay and A.-M. Cretu, *A Visuo-Haptic Framework for Object Recognition \
Inspired from Human Tactile Perception*, Proceedings 4(1), 47 (2018); cite it, the authors in `credits.csv`, and visuohaptic, the software \
that made these touches."""

_SIZES = ((1_000, "n<1K"), (10_000, "1K<n<10K"), (100_000, "10K<n<100K"), (1_000_000, "100K<n<1M"))


def write_card(contents: Contents, experiment: Experiment) -> str:
    """Write the data set's card, Markdown with a YAML header."""
    header = yaml.safe_dump(_header(contents), sort_keys=False, allow_unicode=True)
    return f"---\n{header}---\n{MARK}\n\n{_text(contents, experiment)}"


def _header(contents: Contents) -> dict[str, Any]:
    touches = sum(contents.touches.values())
    licences = {_LICENCES.get(name, "other") for name in contents.licences}
    return {
        "pretty_name": "Touches of 3D objects",
        "license": sorted(licences),
        "task_categories": ["image-classification"],
        "tags": ["tactile", "touch", "3d-objects", "synthetic"],
        "size_categories": [next((name for most, name in _SIZES if touches < most), "n>1M")],
        "configs": [
            {
                "config_name": name,
                "data_files": [{"split": split, "path": file} for split, file in one.files.items()],
            }
            for name, one in CONFIGURATIONS.items()
        ],
        "dataset_info": [
            {
                "config_name": name,
                "features": [
                    {"name": column.name, "dtype": _dtype(column, contents)}
                    for column in one.columns
                ],
            }
            for name, one in CONFIGURATIONS.items()
        ],
    }


def _dtype(column: Column, contents: Contents) -> Any:
    if column.name == "label":
        names = {str(number): name for number, name in enumerate(contents.classes)}
        return {"class_label": {"names": names}}
    if column.dtype == IMPRINT:
        return {"array2_d": {"shape": [contents.taxels] * 2, "dtype": "float32"}}
    if column.dtype == IMAGE:
        return "image"
    return "float64" if pa.types.is_float64(column.dtype) else str(column.dtype)


def _text(contents: Contents, experiment: Experiment) -> str:
    kept = {1: "all touches", 2: "the touches of every second view"}.get(
        contents.every, f"the touches of every {contents.every}th view"
    )
    return f"""# Touches of 3D objects

{sum(contents.touches.values())} simulated tactile imprints of {contents.taxels} × {contents.taxels} taxels, from \
{len(contents.touches)} objects in {len(contents.classes)} classes. Each row is one touch: its picture, its pose \
and the object's class.

![imprints of each class](sample.png)

```python
from datasets import load_dataset

touches = load_dataset("FOLDER")  # splits train and test
lite = load_dataset("FOLDER", "lite")
features = load_dataset("FOLDER", "features")["run"].to_pandas()  # what the experiment classifies by
```

`lite` has no column `imprint` and holds {kept}; it is no larger than 25 MB.

## Splits

All touches of an object are in one split: no object is in both. Of each class a fifth of the objects tests, one at
least; they were drawn with the random seed {contents.seed}.

{_table(("class", "train objects", "test objects", "touches"), _class_rows(contents))}

## Compare with the experiment

Test sequences correctly classified, with 95 % intervals over objects. `experiment.json` holds these figures, every
parameter, and which objects tested in each of the {len(experiment.tested)} divisions of the experiment. Any
scikit-learn classifier is tested on the same divisions, with the same kind of interval, by

```python
import visuohaptic as vh
from sklearn.svm import SVC

print(vh.evaluate(SVC(), features, seed={contents.seed}))
```

{_table(("pipeline", "touches by", "classifier", "correctly classified"), _baseline_rows(experiment))}

## Limits

{LIMITS}

## Citation

{CITATION}

## Columns

Lengths are in object radii: the bounding sphere's centre is the origin, its radius 1, and y points up.

{_table(("column", "unit", "meaning"), [(column.name, column.unit, column.description) for column in COLUMNS])}

## Licences

An imprint comes from the object's model, so take the model's licence to hold for it. Authors and addresses of all
models are in `credits.csv`, licence and author also in each row.

{_table(("licence", "objects"), _licence_rows(contents))}
"""


def _baseline_rows(experiment: Experiment) -> list[tuple[str, ...]]:
    return [
        (
            *(one[name] for name in ("pipeline", "strategy", "classifier")),
            f"{_percent(one['accuracy'])} % ({_percent(one['low'])} to {_percent(one['high'])})",
        )
        for one in experiment.baselines
    ]


def _percent(value: float | None) -> str:
    return "none" if value is None else f"{100 * value:.1f}"


def _class_rows(contents: Contents) -> list[tuple[str, ...]]:
    rows = []
    for name in contents.classes:
        split = [contents.objects_of(name, split) for split in SPLITS]
        touches = sum(contents.touches[key] for keys in split for key in keys)
        rows.append((name, *(str(len(keys)) for keys in split), str(touches)))
    return rows


def _licence_rows(contents: Contents) -> list[tuple[str, str]]:
    return [
        (name or "not known: ask the model's author before you pass it on", str(count))
        for name, count in contents.licences.items()
    ]


def _table(heads: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    lines = [heads, ["---"] * len(heads), *([_escaped(cell) for cell in row] for row in rows)]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


def _escaped(text: str) -> str:
    """Take the meaning from what Markdown and HTML would read in a name."""
    # Between letters, _ and - mean nothing.
    return re.sub(r"([\\`*\[\]<>|&#~$!]|\b_|_\b)", r"\\\1", text)
