"""MTL files: the diffuse colours and images of an OBJ file's materials."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from meshreaders.base.arrays import FloatArray
from meshreaders.base.errors import MeshError
from meshreaders.base.texture import CLAMP, REPEAT
from meshreaders.companions import Companions
from meshreaders.formats.limits import check_parts
from meshreaders.formats.wavefront import (
    as_utf_8,
    name_without_comment,
    numbers_of,
    rest_of,
    statements,
    wrong_number,
)

Triple = tuple[float, float, float]

_SEVERAL = re.compile(r'"[^"]+"|\S.*?\.mtl(?=\s|$)|\S+', re.IGNORECASE)
# A number sign before a digit is part of a name, as in 3ds Max's "Material #25".
_SURE_COMMENT = re.compile(r"\s+#(?!\d).*")
_OPTION = re.compile(r"-(?P<name>[a-z]+)(?=\s)\s*", re.IGNORECASE)
_OPTIONS_BEHIND = re.compile(r"\s+-(?:s|o|t|clamp|blend[uv]|mm|bm|cc|boost|texres|imfchan)\s.*")
_NUMBER = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:e[-+]?\d+)?(?=\s)\s*", re.IGNORECASE)
_WORD = re.compile(r"\S+\s*")
# Options of `map_Kd` with the largest number of numbers, or the number of words, that follow.
_NUMBERS_OF = {"s": 3, "o": 3, "t": 3, "mm": 2}
_WORDS_OF = {"clamp": 1, "blendu": 1, "blendv": 1, "cc": 1, "imfchan": 1, "boost": 1, "texres": 1,
             "bm": 1, "type": 1}  # fmt: skip
_LARGEST_BYTE = 255.0


@dataclass(frozen=True)
class ImageMap:
    """An image that a material names.

    Attributes
    ----------
    names : tuple of str
        Possible names, the likeliest first: a text may end in a comment or in options.
    beside : str
        Material library that names the image.
    scale, offset : tuple of float or None
        Factors of u and v, and numbers added after that; None without.
    wraps : tuple of int
        `REPEAT` or `CLAMP`, for u and v.
    """

    names: tuple[str, ...]
    beside: str
    scale: tuple[float, ...] | None = None
    offset: tuple[float, ...] | None = None
    wraps: tuple[int, int] = (REPEAT, REPEAT)

    def placed(self, uv: FloatArray) -> FloatArray:
        """Return image coordinates (..., 2) of an OBJ file after the scale and offset of the image."""
        if self.scale is not None:
            uv = uv * self.scale
        return uv if self.offset is None else uv + self.offset


@dataclass(frozen=True)
class Material:
    """The colour of a material in an MTL file.

    Attributes
    ----------
    diffuse : tuple of float or None
        Diffuse colour, sRGB, 0 to 1; None without.
    image_map : ImageMap or None
        Image of the material; None without.
    """

    diffuse: Triple | None = None
    image_map: ImageMap | None = None

    @property
    def tint(self) -> Triple:
        """Factor of an image or of vertex colours; 1 if the diffuse colour is missing or black."""
        return self.diffuse if self.diffuse and any(self.diffuse) else (1.0, 1.0, 1.0)


@dataclass(frozen=True)
class Materials:
    """Materials of an OBJ file's libraries, by their names, and the number of libraries that were read."""

    by_name: Mapping[str, Material]
    libraries: int = 0

    def find(self, name: str) -> Material | None:
        """Return the material with a name of the OBJ file; None if there is none.

        Names are compared exactly, then without a comment after ``#``, then without regard to case.
        """
        name = _as_name(name)
        for key in (name, name_without_comment(name)):
            if key in self.by_name:
                return self.by_name[key]
        uncommented = self._uncommented.get(_without_sure_comment(name))
        return uncommented or self._in_any_case.get(name.casefold())

    @cached_property
    def _uncommented(self) -> dict[str, Material | None]:
        return _by_form(self.by_name, _without_sure_comment)

    @cached_property
    def _in_any_case(self) -> dict[str, Material | None]:
        return _by_form(self.by_name, str.casefold)


def read_libraries(lines: Iterable[str], companions: Companions) -> Materials:
    """Read the materials of all libraries that ``mtllib`` lines of an OBJ file name.

    A line may name several libraries. Of materials with equal names, the first counts. Missing libraries are added
    to `companions.missing`, and unreadable colours to `companions.notes`.
    """
    names = dict.fromkeys(name for line in lines for name in _library_names(line, companions))
    check_parts(len(names), "material libraries")
    materials: dict[str, Material] = {}
    libraries = 0
    for name in names:
        try:
            data = companions.read(name)
        except MeshError:
            continue
        libraries += 1
        for material, described in _read_mtl(data, name, companions).items():
            materials.setdefault(material, described)
    return Materials(materials, libraries)


def image_name(image_map: ImageMap, companions: Companions) -> str:
    """Return the first possible name of an image that exists as a file; if none exists, the first name."""
    return _first_existing(image_map.names, companions, image_map.beside)


def _library_names(line: str, companions: Companions) -> list[str]:
    shorter = name_without_comment(line)
    name = _first_existing((line, shorter), companions)
    if companions.has(name):
        return [name]
    return _SEVERAL.findall(shorter)


def _first_existing(names: Sequence[str], companions: Companions, beside: str = "") -> str:
    names = tuple(dict.fromkeys(names))
    if len(names) == 1:
        return names[0]
    return next((name for name in names if companions.has(name, beside)), names[0])


def _read_mtl(data: bytes, library: str, companions: Companions) -> dict[str, Material]:
    materials: dict[str, Material] = {}
    name, unread = None, list[str]()
    for number, line in statements(as_utf_8(data)):
        key = line.split(None, 1)[0].lower() if line.strip() else b""
        if key == b"newmtl":
            name = _as_name(rest_of(line))
            materials[name] = Material()
        elif name is not None and key == b"kd":
            try:
                materials[name] = replace(materials[name], diffuse=_diffuse(line))
            except ValueError as error:
                unread.append(f"line {number}: {error}")
        elif name is not None and key == b"map_kd" and rest_of(line):
            image_map, passed_over = _image_map(rest_of(line), library)
            materials[name] = replace(materials[name], image_map=image_map)
            unread += [f"line {number}: the option {option}" for option in passed_over]
    if unread:
        others = f" and {len(unread) - 1} others" if len(unread) > 1 else ""
        companions.notes.append(f"has colours that are not read: {library}, {unread[0]}{others}")
    return materials


def _by_form(
    materials: Mapping[str, Material], form: Callable[[str], str]
) -> dict[str, Material | None]:
    """Return materials by `form` of their names; None for a form that several names have."""
    by_form: dict[str, Material | None] = {}
    for name, material in materials.items():
        key = form(name)
        by_form[key] = None if key in by_form else material
    return by_form


def _diffuse(line: bytes) -> Triple:
    words = numbers_of(line)
    if words and words[0].lower() in {b"spectral", b"xyz"}:
        raise ValueError(f"{words[0].decode()} is no sRGB")
    try:
        numbers = [float(word) for word in words]
    except ValueError:
        raise ValueError(wrong_number(words)) from None
    if len(numbers) == 1:
        numbers *= 3
    if len(numbers) < 3 or not np.isfinite(numbers[:3]).all():
        raise ValueError(f"Kd of {len(numbers)} numbers; 1 or 3, all finite, are needed")
    # Some programs write 0 to 255. Numbers slightly above 1 come from rounding or overbright colours.
    largest = _LARGEST_BYTE if max(numbers[:3]) > 2.0 else 1.0
    red, green, blue = (min(max(number / largest, 0.0), 1.0) for number in numbers[:3])
    return red, green, blue


def _image_map(text: str, library: str) -> tuple[ImageMap, list[str]]:
    """Return an image with its options, and the ignored options that change its colours."""
    image_map = ImageMap((), library)
    ignored = []
    for name, numbers, option, following in _options(text):
        text = following
        if name == "s":
            image_map = replace(image_map, scale=(*numbers, 1.0, 1.0)[:2])
        elif name == "o":
            image_map = replace(image_map, offset=(*numbers, 0.0, 0.0)[:2])
        elif name == "clamp" and option.lower().endswith("on"):
            image_map = replace(image_map, wraps=(CLAMP, CLAMP))
        elif (name == "mm" and numbers not in {(0.0, 1.0), (0.0,)}) or name == "imfchan":
            ignored.append(option)
    names = (text, name_without_comment(text), _OPTIONS_BEHIND.sub("", text))
    return replace(image_map, names=tuple(dict.fromkeys(names))), ignored


def _options(text: str) -> Iterator[tuple[str, tuple[float, ...], str, str]]:
    """Yield the options before a file name: option name, numbers, text of the option, and following text."""
    while (option := _OPTION.match(text)) is not None:
        name, start, numbers = option["name"].lower(), option.end(), []
        if name not in {*_NUMBERS_OF, *_WORDS_OF}:
            return
        for _ in range(_NUMBERS_OF.get(name, 0)):
            if (number := _NUMBER.match(text, start)) is not None:
                numbers.append(float(number[0]))
                start = number.end()
        for _ in range(_WORDS_OF.get(name, 0)):
            if (word := _WORD.match(text, start)) is not None:
                start = word.end()
        option_text, text = text[:start].strip(), text[start:]
        yield name, tuple(numbers), option_text, text


def _as_name(text: str) -> str:
    return unicodedata.normalize("NFC", " ".join(text.strip().strip('"').split()))


def _without_sure_comment(name: str) -> str:
    return _SURE_COMMENT.sub("", name)
