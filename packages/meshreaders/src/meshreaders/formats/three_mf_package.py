"""Read the zip archive of a 3MF file: its root model, objects and colours of models, and images.

3D Manufacturing Format: core 1.3, production 1.1, materials and properties 1.2 (3mf.io).
"""

from __future__ import annotations

import io
import re
from array import array
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any
from urllib.parse import unquote
from zipfile import ZIP_DEFLATED, ZIP_STORED, ZipFile, ZipInfo

import numpy as np
from lxml import etree
from numpy.typing import NDArray

from meshreaders.base.archives import read_member
from meshreaders.base.arrays import FloatArray, IntArray
from meshreaders.base.errors import MeshError
from meshreaders.base.texture import CLAMP, MIRROR, REPEAT
from meshreaders.companions import LARGEST_BYTES, MOST_BYTES_TOGETHER
from meshreaders.formats.limits import MOST_XML_BYTES, check_xml_size, parse_xml
from meshreaders.polygons import check_corners
from meshreaders.textures import PackedImage, open_image

Key = tuple[str, str]
"""Name of a model in the archive, and id of an object in the model."""

MOST_MEMBERS = 5_000
"""Largest number of members of the archive."""

NO_GROUP = -1
"""Group of a triangle without properties."""

_LONGEST_SHOWN = 80
_START = "3d/3dmodel.model"
_START_TYPE = "http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"
_NAMESPACES = "http://schemas.microsoft.com/3dmanufacturing/"
_READ = tuple(
    f"{_NAMESPACES}{name}/" for name in ("core", "production", "material", "trianglesets", "slice")
)
_MATERIAL = f"{{{_NAMESPACES}material/"
_PRODUCTION = f"{{{_NAMESPACES}production/"
# Elements of these extensions add or remove material: beams, differences, fields and displaced faces.
_SHAPES = re.compile(
    r"\{http://[^}]*/3dmanufacturing/"
    r"(beamlattice|booleanoperations|volumetric|implicit|displacement)/"
)
_MANY = {"vertex", "triangle"}
_MOST_IN_TREE = 256  # largest number of vertices or triangles in the XML tree
_INSIDE_OBJECT = {"mesh", "components", "metadatagroup"}
_INSIDE_MESH = {"vertices", "triangles"}
_WRAPS = {"wrap": REPEAT, "mirror": MIRROR, "clamp": CLAMP, "none": CLAMP}


@dataclass(frozen=True)
class Group:
    """A group of properties of triangles: colours (n, 3), or image coordinates (n, 2) and the id of their image."""

    kind: str
    colours: NDArray[np.uint8] = field(default_factory=lambda: np.zeros((0, 3), np.uint8))
    coordinates: FloatArray = field(default_factory=lambda: np.zeros((0, 2)))
    image: str = ""


@dataclass(frozen=True)
class ModelObject:
    """An object: a mesh, or an assembly of other objects.

    Attributes
    ----------
    vertices, faces : numpy.ndarray
        Shapes (v, 3) and (f, 3); empty for an assembly.
    groups : numpy.ndarray
        Shape (f,): index of the group of each triangle in `group_ids`, or `NO_GROUP`.
    properties : numpy.ndarray
        Shape (f, 3): rows of the group, one per corner.
    components : list
        Key and matrix (4, 4) of each object of the assembly.
    kind : str
        Type of the object, such as ``model`` or ``support``.
    unknown : str
        First element of the object that describes its shape and is not read; "" if all are read.
    passed_over : str
        First other element of the object that is not read; "" if all are read.
    """

    vertices: FloatArray
    faces: IntArray
    groups: IntArray
    properties: IntArray
    group_ids: list[str]
    components: list[tuple[Key, FloatArray]]
    kind: str
    unknown: str
    passed_over: str


@dataclass
class Model:
    """A model of the archive: objects, groups and images by id, and its build items with matrices (4, 4)."""

    objects: dict[str, ModelObject] = field(default_factory=dict)
    groups: dict[str, Group] = field(default_factory=dict)
    images: dict[str, tuple[str, tuple[int, int]]] = field(default_factory=dict)
    items: list[tuple[Key, FloatArray]] = field(default_factory=list)


class Package:
    """The zip archive; models and images are unpacked when they are used."""

    def __init__(self, archive: ZipFile) -> None:
        self._archive = archive
        self._files = {_plain(file.filename): file for file in archive.infolist()}
        self._models: dict[str, Model] = {}
        self._images: dict[str, PackedImage | None] = {}
        self._unpacked = 0
        self._image_bytes = 0

    def start(self) -> str:
        """Return the name of the root model of the archive."""
        if "_rels/.rels" in self._files:
            for relationship in parse_xml(self._xml("_rels/.rels")).iter("{*}Relationship"):
                if relationship.get("Type") == _START_TYPE:
                    return _plain(unquote(relationship.get("Target", "")))
        return _START

    def model(self, name: str) -> Model:
        """Return a model of the archive; raises `MeshError` if it is missing or broken."""
        if name not in self._files:
            raise MeshError(f"it has no model {name[:_LONGEST_SHOWN]!r}")
        if name not in self._models:
            self._models[name] = _Reader(name).read(self._xml(name))
        return self._models[name]

    def find(self, key: Key) -> ModelObject:
        """Return an object of the archive; raises `MeshError` if it is missing."""
        model = self.model(key[0]) if key[0] in self._files else Model()
        if key[1] not in model.objects:
            raise MeshError(f"it places object {key[1]!r} of {key[0]!r}, which is not there")
        return model.objects[key[1]]

    def image(self, name: str) -> PackedImage | None:
        """Return an image of the archive; None if it is missing, too large or no image."""
        name = _plain(unquote(name))
        if name not in self._images:
            file = self._files.get(name)
            packed = None
            if file is not None and file.file_size <= LARGEST_BYTES:
                packed = open_image(self._image_data(file), f"its image {name[:_LONGEST_SHOWN]!r}")
            self._images[name] = packed
        return self._images[name]

    def _image_data(self, file: ZipInfo) -> bytes:
        data = self._read(file, LARGEST_BYTES)
        self._image_bytes += len(data)
        if self._image_bytes > MOST_BYTES_TOGETHER:
            raise MeshError(
                f"its images unpack to more than {MOST_BYTES_TOGETHER / 1e6:.0f} MB, which is the largest allowed size"
            )
        return data

    def _xml(self, name: str) -> bytes:
        file = self._files[name]
        check_xml_size(self._unpacked + file.file_size)
        data = self._read(file, MOST_XML_BYTES - self._unpacked)
        self._unpacked += len(data)
        check_xml_size(self._unpacked)
        return data

    def _read(self, file: ZipInfo, most_bytes: int) -> bytes:
        # Other compression methods may need any amount of memory.
        if file.compress_type not in {ZIP_STORED, ZIP_DEFLATED}:
            raise MeshError("it uses a compression that 3MF does not allow; export it again")
        return read_member(self._archive, file, most_bytes)


class _Reader:
    """Reads a model element by element, so that the XML tree of its vertices is never in memory."""

    def __init__(self, file: str) -> None:
        self._file = file
        self._names: dict[str, str] = {}
        self._model = Model()
        self._points, self._corners = array("d"), array("q")
        self._groups, self._properties = array("q"), array("q")
        self._group_ids: dict[str, int] = {}
        self._rows: list[Any] = []
        self._components: list[tuple[Key, FloatArray]] = []

    def read(self, data: bytes) -> Model:
        if b"<!DOCTYPE" in data:
            raise MeshError("it has a DOCTYPE, which could name other files; none is allowed")
        ends: dict[str, Callable[[Any], None]] = {
            "vertex": self._vertex,
            "triangle": self._triangle,
            "component": lambda element: self._components.append(_reference(element, self._file)),
            "item": lambda element: self._model.items.append(_reference(element, self._file)),
            "object": self._object,
            "base": lambda element: self._rows.append(_colour(element, "displaycolor")),
            "color": lambda element: self._rows.append(_colour(element, "color")),
            "tex2coord": lambda element: self._rows.append(
                [float(element.get("u")), float(element.get("v"))]
            ),
            "texture2d": self._image,
            **dict.fromkeys(("basematerials", "colorgroup"), self._colour_group),
            "texture2dgroup": self._image_group,
            **dict.fromkeys(("compositematerials", "multiproperties"), self._other_group),
        }
        parsed = etree.iterparse(
            io.BytesIO(data), events=("end",),
            resolve_entities=False, load_dtd=False, no_network=True, huge_tree=False,
            remove_comments=True, remove_pis=True,
        )  # fmt: skip
        names, elements_in_tree = self._names, 0
        for _, element in parsed:
            name = names.get(element.tag) or self._name(element)
            if name not in ends:
                parent, before = element.getparent(), element.getprevious()
                if not name and before is not None and not self._name(parent):
                    # Of another extension, such as slices, only names of elements in objects are needed.
                    parent.remove(before)
                continue
            try:
                ends[name](element)
            except (TypeError, ValueError) as error:
                attributes = str(dict(element.attrib))[:_LONGEST_SHOWN]
                raise MeshError(f"{self._file}: {name} {attributes} can't be read") from error
            if name in _MANY:
                elements_in_tree += 1
                if elements_in_tree == _MOST_IN_TREE:
                    # Drop elements that have been read, so that the tree stays small.
                    parent = element.getparent()
                    del parent[: parent.index(element)]
                    elements_in_tree = 0
        self._check_root(parsed.root)
        return self._model

    def _name(self, element: Any) -> str:
        """Return the name of an element of the core or the materials extension, without namespace; "" for another."""
        if element.tag not in self._names:
            space, _, name = element.tag.rpartition("}")
            core = element.getroottree().getroot().tag.rpartition("}")[0]
            is_known = space == core or space.startswith(_MATERIAL)
            self._names[element.tag] = name if is_known else ""
        return self._names[element.tag]

    def _unread(self, element: Any) -> tuple[str, str]:
        """Return the first unread element of an object that describes its shape, and the first other one; "" for none."""
        # Elements of extensions that are not required are ignored (core 1.3, attribute `requiredextensions` of `model`).
        shape, other = "", ""
        meshes = [child for child in element if self._name(child) == "mesh"]
        has_shape = meshes or any(self._name(child) == "components" for child in element)
        for parent, known in [
            (element, _INSIDE_OBJECT),
            *((mesh, _INSIDE_MESH) for mesh in meshes),
        ]:
            for child in parent:
                if self._name(child) in known or _tag(child) == "trianglesets":
                    continue
                if self._name(child) or _SHAPES.match(child.tag) or not has_shape:
                    shape = shape or _tag(child)[:_LONGEST_SHOWN]
                else:
                    other = other or _tag(child)[:_LONGEST_SHOWN]
        return shape, other

    def _check_root(self, root: Any) -> None:
        """Raise `MeshError` if the document has a DOCTYPE, or requires an extension that is not read."""
        if root.getroottree().docinfo.internalDTD is not None:
            raise MeshError("it has a DOCTYPE, which could name other files; none is allowed")
        for prefix in root.get("requiredextensions", "").split():
            space = root.nsmap.get(prefix, prefix)
            if not space.startswith(_READ):
                raise MeshError(
                    f"{self._file} requires the extension {space[:_LONGEST_SHOWN]}, which is not read"
                )

    def _vertex(self, element: Any) -> None:
        get = element.get
        self._points.extend((float(get("x")), float(get("y")), float(get("z"))))

    def _triangle(self, element: Any) -> None:
        get = element.get
        self._corners.extend((int(get("v1")), int(get("v2")), int(get("v3"))))
        first_property = get("p1")
        if first_property is None:
            self._groups.append(-2 if get("pid") is None else NO_GROUP)
            self._properties.extend((0, 0, 0))
            return
        group = get("pid")
        # -2 means group and property of the object, -3 only its group.
        self._groups.append(
            -3 if group is None else self._group_ids.setdefault(group, len(self._group_ids))
        )
        self._properties.extend(
            (int(first_property), int(get("p2", first_property)), int(get("p3", first_property)))
        )

    def _object(self, element: Any) -> None:
        vertices = np.frombuffer(self._points, dtype=np.float64).reshape(-1, 3)
        faces = np.frombuffer(self._corners, dtype=np.int64).reshape(-1, 3)
        groups = np.frombuffer(self._groups, dtype=np.int64)
        properties = np.frombuffer(self._properties, dtype=np.int64).reshape(-1, 3)
        object_id = element.get("id", "")
        try:
            check_corners(faces.ravel(), len(vertices))
        except MeshError as error:
            raise MeshError(f"object {object_id[:_LONGEST_SHOWN]!r}: {error}") from error
        default_group = NO_GROUP
        if element.get("pid") is not None:
            default_group = self._group_ids.setdefault(element.get("pid"), len(self._group_ids))
        properties[groups == -2] = int(element.get("pindex", 0))
        groups[groups <= -2] = default_group
        self._model.objects[object_id] = ModelObject(
            vertices, faces, groups, properties, list(self._group_ids), self._components,
            element.get("type", "model"), *self._unread(element),
        )  # fmt: skip
        self._points, self._corners = array("d"), array("q")
        self._groups, self._properties = array("q"), array("q")
        self._group_ids, self._components = {}, []
        element.clear()

    def _colour_group(self, element: Any) -> None:
        colours = np.array(self._rows, dtype=np.uint8).reshape(-1, 3)
        self._add(element, Group(_tag(element), colours))

    def _image_group(self, element: Any) -> None:
        coordinates = np.array(self._rows, dtype=np.float64).reshape(-1, 2)
        image = element.get("texid", "")
        self._add(element, Group(_tag(element), coordinates=coordinates, image=image))

    def _other_group(self, element: Any) -> None:
        self._add(element, Group(_tag(element)))

    def _add(self, element: Any, group: Group) -> None:
        self._model.groups[element.get("id", "")] = group
        self._rows = []

    def _image(self, element: Any) -> None:
        across, up = (
            _WRAPS.get(element.get(name, "wrap"), REPEAT) for name in ("tilestyleu", "tilestylev")
        )
        self._model.images[element.get("id", "")] = element.get("path", ""), (across, up)


def _colour(element: Any, name: str) -> list[int]:
    text = element.get(name) or ""
    if text[:1] != "#" or len(text) not in {7, 9}:
        raise MeshError(f"{_tag(element)} has {name} {text[:_LONGEST_SHOWN]!r}; #RRGGBB is needed")
    return list(bytes.fromhex(text[1:7]))


def _reference(element: Any, file: str) -> tuple[Key, FloatArray]:
    elsewhere = next(
        (
            text
            for name, text in element.attrib.items()
            if name.startswith(_PRODUCTION) and name.endswith("}path")
        ),
        None,
    )
    key = (file if elsewhere is None else _plain(elsewhere)), element.get("objectid", "")
    return key, _transform(element)


def _transform(element: Any) -> FloatArray:
    """Return the transform of an element as a matrix (4, 4) for column vectors; the file has it for row vectors."""
    words = element.get("transform", "1 0 0 0 1 0 0 0 1 0 0 0").split()
    if len(words) != 12:
        raise MeshError(f"a transform has {len(words)} numbers; 12 are needed")
    matrix = np.eye(4)
    matrix[:3] = np.array([float(word) for word in words]).reshape(4, 3).T
    return matrix


def _tag(element: Any) -> str:
    return str(element.tag).rpartition("}")[2]


def _plain(name: str) -> str:
    return name.replace("\\", "/").strip("/").lower()
