"""The data set's description for machines: croissant.json (MLCommons Croissant 1.1)."""

from __future__ import annotations

import hashlib
import json
from pathlib import Path
from typing import Any

import pyarrow as pa

from visuohaptic import __version__
from visuohaptic.export.card import CONFIGURATIONS
from visuohaptic.export.columns import IMAGE, IMPRINT
from visuohaptic.export.contents import Contents
from visuohaptic.tables.schema import TEXT, Column

_FORMAT = "http://mlcommons.org/croissant/1.1"
# The context that the specification gives.
_TERMS = (
    "arrayShape citeAs column equivalentProperty extract field fileProperty fileObject fileSet format includes "
    "isArray isLiveDataset jsonPath key md5 parentField path recordSet references regex repeated replace "
    "samplingRate separator source subField transform"
)
_CONTEXT: dict[str, Any] = {
    "@language": "en",
    "@vocab": "https://schema.org/",
    "sc": "https://schema.org/",
    "cr": "http://mlcommons.org/croissant/",
    "rai": "http://mlcommons.org/croissant/RAI/",
    "dct": "http://purl.org/dc/terms/",
    "conformsTo": "dct:conformsTo",
    "data": {"@id": "cr:data", "@type": "@json"},
    "dataType": {"@id": "cr:dataType", "@type": "@vocab"},
    "examples": {"@id": "cr:examples", "@type": "@json"},
    **{term: f"cr:{term}" for term in _TERMS.split()},
}
_TYPES = {
    TEXT: "sc:Text",
    pa.int32(): "sc:Integer",
    pa.int64(): "sc:Integer",
    pa.float64(): "sc:Float",
    IMPRINT: "sc:Float",
    IMAGE: "sc:ImageObject",
}


def describe_files(contents: Contents, folder: Path) -> str:
    """Describe the Parquet files that were written into a folder as Croissant JSON."""
    parts = [
        (f"{name}_{split}", one.columns, file)
        for name, one in CONFIGURATIONS.items()
        for split, file in one.files.items()
    ]
    described = {
        "@context": _CONTEXT,
        "@type": "sc:Dataset",
        "conformsTo": _FORMAT,
        "name": "touches-of-3d-objects",
        "description": f"Simulated tactile imprints of {len(contents.touches)} objects in "
        f"{len(contents.classes)} classes, split by object; licences and authors are in each row.",
        "license": [
            f"https://spdx.org/licenses/{name}.html" if name else "not known"
            for name in contents.licences
        ],
        "version": __version__,
        "creator": {"@type": "sc:Organization", "name": "visuohaptic"},
        "distribution": [_file_object(folder, file) for _, _, file in parts],
        "recordSet": [
            {
                "@type": "cr:RecordSet",
                "@id": name,
                "name": name,
                "field": [_field(column, name, file, contents.taxels) for column in columns],
            }
            for name, columns, file in parts
        ],
    }
    return json.dumps(described, indent=2) + "\n"


def _file_object(folder: Path, name: str) -> dict[str, str]:
    with (folder / name).open("rb") as stream:
        digest = hashlib.file_digest(stream, "sha256").hexdigest()
    return {
        "@type": "cr:FileObject",
        "@id": name,
        "name": name,
        "contentUrl": name,
        "contentSize": f"{(folder / name).stat().st_size} B",
        "encodingFormat": "application/x-parquet",
        "sha256": digest,
    }


def _field(column: Column, record_set: str, file: str, taxels: int) -> dict[str, Any]:
    source: dict[str, Any] = {
        "fileObject": {"@id": file},
        "extract": {"column": column.name},
    }
    if column.dtype == IMAGE:
        source["transform"] = {"jsonPath": "bytes"}
    field: dict[str, Any] = {
        "@type": "cr:Field",
        "@id": f"{record_set}/{column.name}",
        "name": column.name,
        "description": column.description,
        "dataType": _TYPES[column.dtype],
        "source": source,
    }
    if column.dtype == IMPRINT:
        field |= {"isArray": True, "arrayShape": f"{taxels},{taxels}"}
    return field
