"""The XML of a COLLADA file: elements by id, arrays, and colours and images of materials.

COLLADA 1.4.1 (Khronos, 2008) and 1.5.
"""

from __future__ import annotations

import io
from dataclasses import dataclass
from typing import Any, Literal
from urllib.parse import unquote
from zipfile import is_zipfile

import numpy as np

from meshreaders.base.arrays import FloatArray, IntArray
from meshreaders.base.errors import MeshError
from meshreaders.base.texture import CLAMP, MIRROR, REPEAT
from meshreaders.companions import Companions
from meshreaders.formats.limits import parse_xml
from meshreaders.textures import PackedImage

MOST_ELEMENTS = 200_000
"""Largest number of XML elements, without elements ``p``: old files have one per polygon."""

_UP_AXES: dict[str, Literal["x", "y", "z"]] = {"X_UP": "x", "Y_UP": "y", "Z_UP": "z"}
_LONGEST_SHOWN = 80
_WRAPS = {"WRAP": REPEAT, "MIRROR": MIRROR, "CLAMP": CLAMP, "BORDER": CLAMP, "NONE": CLAMP}
_WIDTHS = {"float2": 2, "float3": 3, "float4": 4, "float3x3": 9, "float4x4": 16}
_SHADERS = ("phong", "lambert", "blinn")
# Settings of a texture that Maya and 3ds Max write, with their neutral values.
_MOVES = {
    "repeatU": 1.0,
    "repeatV": 1.0,
    "offsetU": 0.0,
    "offsetV": 0.0,
    "rotateUV": 0.0,
    "translateFrameU": 0.0,
    "translateFrameV": 0.0,
    "rotateFrame": 0.0,
    "stagger": 0.0,
}


@dataclass(frozen=True)
class Appearance:
    """Appearance of a material: diffuse colour (sRGB, 0 to 1), or image and name of its image coordinates."""

    colour: tuple[float, float, float] | None = None
    image: PackedImage | None = None
    wraps: tuple[int, int] = (REPEAT, REPEAT)
    coordinates: str = ""


def parse_collada(data: bytes) -> Any:
    """Return the root of a COLLADA file, an ``lxml`` element.

    Raises `MeshError` with the reason if `data` is other XML or an archive.
    """
    if is_zipfile(io.BytesIO(data)):
        raise MeshError("it is a zip archive; unpack it first")
    root = parse_xml(data)
    if tag(root) != "COLLADA":
        raise MeshError(f"it begins with {tag(root)[:_LONGEST_SHOWN]!r}; COLLADA is needed")
    return root


class ColladaDocument:
    """A COLLADA file whose entries are checked when they are used.

    Attributes
    ----------
    root : lxml element
        Root of the document.
    companions : Companions
        Files that the document refers to.
    """

    def __init__(self, root: Any, companions: Companions) -> None:
        self.root = root
        elements = sum(1 for element in self.root.iter() if tag(element) != "p")
        if elements > MOST_ELEMENTS:
            raise MeshError(f"it has {elements} elements; {MOST_ELEMENTS} are allowed")
        self.companions = companions
        # Some programs use an id twice: for a node and its shape, or for sources of several shapes.
        self._named: dict[tuple[Any, str, str], Any] = {}
        for element in self.root.iter():
            if element.get("id"):
                for scope in (None, _scope(element)):
                    self._named.setdefault((scope, tag(element), element.get("id")), element)
        self._arrays: dict[Any, FloatArray] = {}
        self._appearances: dict[str, Appearance] = {}
        self._images: dict[str, PackedImage | None] = {}

    @property
    def up_axis(self) -> Literal["x", "y", "z"]:
        """The axis that points up: x, y or z."""
        name = (self.root.findtext("{*}asset/{*}up_axis") or "Y_UP").strip()
        if name not in _UP_AXES:
            raise MeshError(
                f"its up_axis is {name[:_LONGEST_SHOWN]!r}; {', '.join(_UP_AXES)} are allowed"
            )
        return _UP_AXES[name]

    def referred(self, element: Any, kind: str, label: str, attribute: str = "url") -> Any:
        """Return the element of a kind, such as ``geometry``, that an attribute of `element` refers to; `label` is for errors."""
        name = (element.get(attribute) or "").strip()
        if name and not name.startswith("#"):
            raise MeshError(
                f"{label} refers to {name[:_LONGEST_SHOWN]!r}; only references within the file are read"
            )
        for spelt in (name[1:], unquote(name[1:])):
            for scope in (_scope(element), None):
                if (scope, kind, spelt) in self._named:
                    return self._named[scope, kind, spelt]
        raise MeshError(f"{label} refers to {kind} {name[:_LONGEST_SHOWN]!r}, which is not there")

    def named(self, kind: str, name: str) -> Any:
        """Return the first element of a kind and an id, or None."""
        return self._named.get((None, kind, name))

    def rows(self, source: Any) -> FloatArray:
        """Return the numbers of a source, shape (n, k); k is the number of its named parameters."""
        if source not in self._arrays:
            self._arrays[source] = self._read_rows(source)
        return self._arrays[source]

    def _read_rows(self, source: Any) -> FloatArray:
        label = f"source {source.get('id', '')[:_LONGEST_SHOWN]!r}"
        accessor = source.find("{*}technique_common/{*}accessor")
        if accessor is None:
            raise MeshError(f"{label} has no accessor")
        array = self.referred(accessor, "float_array", label, "source")
        values = numbers(array.text, label)
        start, stride = int(accessor.get("offset", 0)), int(accessor.get("stride", 1))
        count = int(accessor.get("count", 0))
        columns = _columns(accessor) or list(range(stride))
        if min(start, count) < 0 or max(columns) >= stride:
            raise MeshError(f"{label} has {len(columns)} columns in steps of {stride}")
        needed = start + stride * (count - 1) + max(columns) + 1 if count else 0
        if needed > len(values):
            raise MeshError(
                f"{label} is truncated: it claims {needed} numbers, and {len(values)} are there"
            )
        index = start + stride * np.arange(count)[:, None] + np.array(columns)
        return values[index]

    def words(self, source: Any) -> list[str]:
        """Return the names of a source."""
        for kind in ("Name_array", "IDREF_array", "SIDREF_array"):
            if (text := source.findtext(f"{{*}}{kind}")) is not None:
                return list(text.split())
        raise MeshError(f"source {source.get('id', '')[:_LONGEST_SHOWN]!r} has no names")

    def appearance(self, material: str) -> Appearance:
        """Return the appearance of the material with this id."""
        if material not in self._appearances:
            self._appearances[material] = self._read_appearance(material)
        return self._appearances[material]

    def _read_appearance(self, material: str) -> Appearance:
        label = f"material {material[:_LONGEST_SHOWN]!r}"
        entry = self.named("material", material)
        instance = entry.find("{*}instance_effect")
        if instance is None:
            self.companions.notes.append(f"has faces without their colours: {label} has no effect")
            return Appearance()
        try:
            effect = self.referred(instance, "effect", label)
        except MeshError as error:
            # The shape needs no effect.
            self.companions.notes.append(f"has faces without their colours: {error}")
            return Appearance()
        profile = effect.find("{*}profile_COMMON")
        if profile is None:
            self.companions.notes.append(f"has no plain colour for {label}, which is read as grey")
            return Appearance()
        for shader in _SHADERS:
            diffuse = profile.find(f"{{*}}technique/{{*}}{shader}/{{*}}diffuse")
            if diffuse is not None:
                return self._of_diffuse(diffuse, profile, effect, label)
        # A constant shader has its colour in `emission`.
        emission = profile.find("{*}technique/{*}constant/{*}emission")
        return (
            Appearance() if emission is None else self._of_diffuse(emission, profile, effect, label)
        )

    def _of_diffuse(self, diffuse: Any, profile: Any, effect: Any, label: str) -> Appearance:
        texture, colour = diffuse.find("{*}texture"), diffuse.find("{*}color")
        if texture is not None:
            return self._of_texture(texture, profile, effect, label)
        text = None if colour is None else colour.text
        parameter = diffuse.find("{*}param")
        if parameter is not None:
            name = parameter.get("ref")
            for candidate in [*profile.iter("{*}newparam"), *effect.iterfind("{*}newparam")]:
                if candidate.get("sid") == name:
                    text = next(
                        (value.text for value in candidate if tag(value).startswith("float")), None
                    )
        if text is None:
            return Appearance()
        values = np.clip(np.nan_to_num(numbers(text, label)[:3]), 0.0, 1.0)
        if len(values) < 3:
            raise MeshError(f"{label} has a colour of {len(values)} numbers; 3 or 4 are needed")
        return Appearance((float(values[0]), float(values[1]), float(values[2])))

    def _of_texture(self, texture: Any, profile: Any, effect: Any, label: str) -> Appearance:
        for move in texture.iter(*(f"{{*}}{name}" for name in _MOVES)):
            if numbers(move.text, label).tolist() != [_MOVES[tag(move)]]:
                self.companions.notes.append(
                    f"moves the image of {label} by {tag(move)}, which is not read"
                )
        parameters = {
            parameter.get("sid"): parameter
            for parameter in [*effect.iterfind("{*}newparam"), *profile.iter("{*}newparam")]
        }
        name, wraps = texture.get("texture", ""), (REPEAT, REPEAT)
        # COLLADA 1.4 refers to an image by sampler and surface, 1.5 by sampler and instance_image.
        sampler = parameters.get(name)
        if sampler is not None:
            across, up = (
                _WRAPS.get((sampler.findtext(f".//{{*}}{name}") or "WRAP").strip(), REPEAT)
                for name in ("wrap_s", "wrap_t")
            )
            wraps = across, up
            name = (sampler.findtext(".//{*}source") or "").strip()
            direct = sampler.find(".//{*}instance_image")
            if direct is not None:
                name = direct.get("url", "").removeprefix("#")
        surface = parameters.get(name)
        if surface is not None:
            name = (surface.findtext(".//{*}init_from") or "").strip()
        return Appearance(None, self._image(name, label), wraps, texture.get("texcoord", ""))

    def _image(self, name: str, label: str) -> PackedImage | None:
        if name in self._images:
            return self._images[name]
        described = self.named("image", name)
        if described is None:
            clause = f"image {name[:_LONGEST_SHOWN]!r} of {label}, which the file does not have"
            self.companions.missing.append(clause)
            return None
        start = described.find("{*}init_from")
        address = "" if start is None else (start.findtext("{*}ref") or start.text or "").strip()
        if not address:
            self.companions.missing.append(
                f"image {name[:_LONGEST_SHOWN]!r}, which is not a separate file"
            )
        self._images[name] = self.companions.image(address) if address else None
        return self._images[name]


def _scope(element: Any) -> Any:
    """Return the geometry, controller or effect that an element is in, or None."""
    return next(element.iterancestors("{*}geometry", "{*}controller", "{*}effect"), None)


def _columns(accessor: Any) -> list[int]:
    """Return the columns of the named parameters of an accessor; columns without name are skipped."""
    columns: list[int] = []
    start = 0
    for parameter in accessor.iterfind("{*}param"):
        width = _WIDTHS.get(parameter.get("type", ""), 1)
        if parameter.get("name"):
            columns += range(start, start + width)
        start += width
    return columns


def tag(element: Any) -> str:
    """Return the name of an element without its namespace."""
    return str(element.tag).rpartition("}")[2]


def numbers(text: str | None, label: str) -> FloatArray:
    """Return the numbers of a text, shape (n,); raises `MeshError` with the first word that is no number."""
    return _parsed(text, np.float64, float, f"{label} holds a word that is no number")


def integers(text: str | None, label: str) -> IntArray:
    """Return the integers of a text, shape (n,); raises `MeshError` with the first word that is no integer."""
    return _parsed(text, np.int64, int, f"{label} holds a word that is no integer")


def _parsed(text: str | None, dtype: Any, parse: Any, message: str) -> Any:
    if text is None or not text.strip():
        return np.empty(0, dtype)
    try:
        # `split` would take many times the memory of the text.
        return np.fromstring(text, dtype=dtype, sep=" ")
    except ValueError:
        for word in text.split():
            try:
                parse(word)
            except ValueError:
                raise MeshError(f"{message}: {word[:_LONGEST_SHOWN]!r}") from None
        raise
