"""The container of a glTF file: its JSON, and the buffers, accessors and images that the JSON describes.

glTF 2.0 (ISO/IEC 12113:2022), sections 3.4 to 3.8 and 4.4 (GLB).
"""

from __future__ import annotations

import binascii
import json
import struct
from collections.abc import Collection
from typing import Any
from urllib.parse import unquote, unquote_to_bytes

import numpy as np
from numpy.typing import NDArray

from visuohaptic.base.arrays import FloatArray
from visuohaptic.base.errors import MeshError
from visuohaptic.meshes.companions import Companions
from visuohaptic.meshes.textures import PackedImage, open_image

MOST_IMAGE_BYTES = 512 * 10**6
"""Packed images of one file: many may refer to the same bytes."""

READ_EXTENSIONS = frozenset(
    {
        "EXT_mesh_gpu_instancing",
        "EXT_texture_avif",
        "EXT_texture_webp",
        "KHR_materials_pbrSpecularGlossiness",
        "KHR_mesh_quantization",
        "KHR_node_visibility",
        "KHR_texture_transform",
    }
)

HARMLESS_EXTENSIONS = frozenset(
    {
        # How light is reflected, bent or sent out; the base colour stays what it is.
        *(f"KHR_materials_{name}" for name in (
            "anisotropy", "clearcoat", "diffuse_transmission", "dispersion", "emissive_strength", "ior",
            "iridescence", "sheen", "specular", "transmission", "unlit", "volume", "volume_scatter",
        )),
        "VRMC_materials_mtoon", "VRMC_materials_hdr_emissiveMultiplier",
        "MSFT_packing_normalRoughnessMetallic", "MSFT_packing_occlusionRoughnessMetallic",
        # Other materials and coarser shapes, which stand beside those that are shown first.
        "KHR_materials_variants", "MSFT_lod",
        # Lights, sounds, motion, what may be clicked, and what is known about a part.
        "KHR_lights_punctual", "EXT_lights_ies", "EXT_lights_image_based",
        "KHR_audio_emitter", "MSFT_audio_emitter", "KHR_animation_pointer",
        "KHR_node_hoverability", "KHR_node_selectability", "KHR_interactivity",
        "KHR_implicit_shapes", "KHR_physics_rigid_bodies", "OMI_collider", "OMI_physics_body",
        "OMI_physics_shape", "VRM", "VRMC_vrm", "VRMC_springBone", "VRMC_node_constraint",
        "KHR_xmp", "KHR_xmp_json_ld", "AGI_stk_metadata", "EXT_feature_metadata",
        "EXT_instance_features", "EXT_mesh_features", "EXT_structural_metadata",
        "CESIUM_primitive_outline", "GODOT_single_root", "CESIUM_RTC",
    }
)  # fmt: skip
"""Extensions that can change neither a surface nor its base colour."""

# A file that does not require one of these has the same numbers or an image beside it, unpacked.
_WITH_FALLBACK = frozenset({"KHR_draco_mesh_compression", "KHR_texture_basisu", "MSFT_texture_dds"})

_COMPONENTS = {5120: "<i1", 5121: "<u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
_WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}
_GLB_HEADER = struct.Struct("<4sII")
_CHUNK_HEADER = struct.Struct("<I4s")
_INLINE = "data:"
_LONGEST_SHOWN = 80


class GltfDocument:
    """A glTF file whose entries are checked when they are used.

    Attributes
    ----------
    tree : dict
        The JSON of the file.
    companions : Companions
        The files beside it.
    """

    def __init__(self, data: bytes, companions: Companions) -> None:
        self._size = len(data)
        text, self._chunk = _unpacked(data) if data[:4] == b"glTF" else (data, None)
        self.tree = _parsed(_decoded(text))
        self.companions = companions
        self._buffers: dict[object, memoryview] = {}
        self._images: dict[object, PackedImage | None] = {}
        self._image_bytes = 0
        version = str(self.tree.get("asset", {}).get("version", "2.0"))
        if not version.startswith("2."):
            raise MeshError(f"it is of version {version[:_LONGEST_SHOWN]} of glTF; 2.0 is needed")
        for name in self.tree.get("extensionsRequired", ()):
            if name not in READ_EXTENSIONS | HARMLESS_EXTENSIONS:
                raise MeshError(
                    f"it requires the extension {str(name)[:_LONGEST_SHOWN]}, which is not read; export "
                    "it without"
                )

    def entry(self, kind: str, index: Any, place: str) -> dict[str, Any]:
        """Return an entry of a list of the file, such as ``nodes``, that `place` refers to."""
        entries = self.tree.get(kind, [])
        if not isinstance(index, int) or not 0 <= index < len(entries):
            raise MeshError(
                f"{place} refers to number {str(index)[:_LONGEST_SHOWN]} of its {kind}; "
                f"{len(entries)} are there, counted from 0"
            )
        found = entries[index]
        if not isinstance(found, dict):
            raise MeshError(f"number {index} of its {kind} is no object")
        return found

    def count(self, accessor: Any, place: str) -> int:
        """Return the rows that an accessor claims; they need not be there."""
        described = self.entry("accessors", accessor, place)
        count: int = required(described, "count", int, f"accessor {accessor}")
        if count < 0:
            raise MeshError(f"accessor {accessor} has the count {str(count)[:_LONGEST_SHOWN]}")
        return count

    def stored(self, accessor: int, place: str, *widths: int) -> NDArray[Any]:
        """Return the numbers of an accessor as they are stored, shape (n, k), k one of `widths`."""
        described = self.entry("accessors", accessor, place)
        refuse_unknown(described, f"accessor {accessor}", ())
        width = _WIDTHS.get(described.get("type", ""), 0)
        if width not in widths or described.get("componentType") not in _COMPONENTS:
            raise MeshError(
                f"{place} is accessor {accessor}, of {str(described.get('type'))[:9]} and component type "
                f"{str(described.get('componentType'))[:9]}, which can't be"
            )
        dtype = np.dtype(_COMPONENTS[described["componentType"]])
        count = self.count(accessor, place)
        if "bufferView" in described:
            rows = self._rows(described, dtype, count, width, f"accessor {accessor}")
        elif "sparse" not in described:
            raise MeshError(f"{place} is accessor {accessor}, which has no data")
        elif count > self._size:
            raise MeshError(f"it claims {count} rows without data in a file of {self._size} bytes")
        else:
            rows = np.zeros((count, width), dtype)
        if "sparse" in described:
            rows = self._patched(rows, described["sparse"], f"accessor {accessor}")
        return rows

    def numbers(self, accessor: int, place: str, *widths: int) -> FloatArray:
        """Return the numbers of an accessor, integers divided by their largest if it says `normalized`."""
        stored = self.stored(accessor, place, *widths)
        if self.entry("accessors", accessor, place).get("normalized"):
            return _shares(stored)
        return stored.astype(np.float64)

    def shares(self, accessor: int, place: str, *widths: int) -> FloatArray:
        """Return the numbers of an accessor for which integers always stand for shares of their largest."""
        return _shares(self.stored(accessor, place, *widths))

    def image(self, index: int, place: str) -> PackedImage | None:
        """Open an image, or return None and say in the companions' `missing` why it is not there."""
        described = self.entry("images", index, place)
        refuse_unknown(described, f"image {index}", ())
        key = described.get("uri", ("view", described.get("bufferView")))
        if key not in self._images:
            self._images[key] = self._opened(described, index)
        return self._images[key]

    def _opened(self, described: dict[str, Any], index: int) -> PackedImage | None:
        name = described.get("uri")
        if name is None:
            data = bytes(self._view(described.get("bufferView"), f"image {index}"))
        elif name.startswith(_INLINE):
            data = _decoded_address(name)
        else:
            return self.companions.image(name)
        self._image_bytes += len(data)
        if self._image_bytes > MOST_IMAGE_BYTES:
            raise MeshError(
                f"its images have more than {MOST_IMAGE_BYTES / 1e6:.0f} MB, which are allowed"
            )
        image = open_image(data, f"image {index}")
        if image is None:
            kind = str(described.get("mimeType", "no type"))[:_LONGEST_SHOWN]
            self.companions.missing.append(
                f"image {index} ({kind}), which is no image that can be read"
            )
        return image

    def _rows(
        self, described: dict[str, Any], dtype: np.dtype[Any], count: int, width: int, place: str
    ) -> NDArray[Any]:
        index = described["bufferView"]
        data = self._view(index, place)
        row_bytes = width * dtype.itemsize
        stride = self.entry("bufferViews", index, place).get("byteStride") or row_bytes
        start = described.get("byteOffset", 0)
        needed = start + stride * (count - 1) + row_bytes if count else 0
        if stride < row_bytes or start < 0 or needed > len(data):
            raise MeshError(
                f"{place} is truncated: it needs {needed} bytes, in steps of {stride}, of buffer view "
                f"{index}, and {len(data)} are there"
            )
        if not count:
            return np.zeros((0, width), dtype)
        return np.ndarray((count, width), dtype, data, start, (stride, dtype.itemsize))

    def _patched(self, rows: NDArray[Any], sparse: dict[str, Any], place: str) -> NDArray[Any]:
        count = required(sparse, "count", int, place)
        places, values = (required(sparse, name, dict, place) for name in ("indices", "values"))
        if places.get("componentType") not in {5121, 5123, 5125}:
            raise MeshError(f"{place} has sparse rows whose numbers are no unsigned integers")
        numbers = self._rows(
            places, np.dtype(_COMPONENTS[places["componentType"]]), count, 1, place
        )
        if (numbers >= len(rows)).any():
            raise MeshError(f"{place} has a sparse row {numbers.max()}; it has {len(rows)} rows")
        patched = rows.copy()
        patched[numbers[:, 0]] = self._rows(values, rows.dtype, count, rows.shape[1], place)
        return patched

    def _view(self, index: Any, place: str) -> memoryview:
        described = self.entry("bufferViews", index, place)
        refuse_unknown(described, f"buffer view {index}", ())
        data = self._buffer(described.get("buffer"), f"buffer view {index}")
        start, length = described.get("byteOffset", 0), described.get("byteLength", 0)
        if start < 0 or length < 0 or start + length > len(data):
            raise MeshError(
                f"buffer view {index} is truncated: it needs bytes {start} to {start + length}, and "
                f"{len(data)} are there"
            )
        return data[start : start + length]

    def _buffer(self, index: Any, place: str) -> memoryview:
        described = self.entry("buffers", index, place)
        refuse_unknown(described, f"buffer {index}", ())
        if (described.get("uri") or "").startswith(_INLINE):
            # The address is as long as its bytes and is not needed beside them.
            self._buffers[index] = memoryview(_decoded_address(described.pop("uri")))
        name = described.get("uri")
        # Many buffers may name one file.
        key = index if name is None else name
        if key not in self._buffers:
            self._buffers[key] = memoryview(self._loaded(name, index))
        data, promised = self._buffers[key], described.get("byteLength", 0)
        if len(data) < promised:
            raise MeshError(
                f"buffer {index} is truncated: it promises {promised} bytes, and {len(data)} are there"
            )
        return data

    def _loaded(self, name: str | None, index: int) -> bytes | memoryview:
        if name is None:
            if index != 0 or self._chunk is None:
                raise MeshError(f"buffer {index} has no data")
            return self._chunk
        return self.companions.read(name)


def required(holder: dict[str, Any], name: str, kind: type, place: str) -> Any:
    """Return what an entry must have; raises `MeshError` if it has none or of another type."""
    if not isinstance(holder.get(name), kind):
        found = "none" if name not in holder else type(holder[name]).__name__
        raise MeshError(f"{place} needs {name!r} of type {kind.__name__}, and has {found}")
    return holder[name]


def refuse_unknown(holder: dict[str, Any], place: str, known: Collection[str]) -> None:
    """Refuse an entry in use that has an extension neither `known` nor harmless."""
    for name in holder.get("extensions", {}):
        if name not in known and name not in HARMLESS_EXTENSIONS | _WITH_FALLBACK:
            raise MeshError(
                f"{place} has the extension {name[:_LONGEST_SHOWN]}, which is not read; export it without"
            )


def refuse_other_keys(holder: dict[str, Any], place: str, known: Collection[str]) -> None:
    """Refuse an entry in use that has a key which glTF 2.0 does not have."""
    for name in holder:
        if name not in known and name not in {"name", "extras", "extensions"}:
            raise MeshError(f"{place} has {name[:_LONGEST_SHOWN]!r}, which is not read")


def _unpacked(data: bytes) -> tuple[bytes, memoryview | None]:
    """Return the JSON of a GLB, and its binary chunk, if any."""
    if len(data) < _GLB_HEADER.size + _CHUNK_HEADER.size:
        raise MeshError(f"it is truncated: {len(data)} bytes are there")
    _, version, promised = _GLB_HEADER.unpack_from(data)
    if version != 2:
        raise MeshError(f"it is of version {version} of GLB; 2 is needed")
    if promised > len(data):
        raise MeshError(
            f"it is truncated: its header promises {promised} bytes, and {len(data)} are there"
        )
    chunks: dict[bytes, memoryview] = {}
    start, whole = _GLB_HEADER.size, memoryview(data)
    while start + _CHUNK_HEADER.size <= promised:
        length, kind = _CHUNK_HEADER.unpack_from(data, start)
        start += _CHUNK_HEADER.size
        if start + length > promised:
            raise MeshError(
                f"it is truncated: a chunk promises {length} bytes, and {promised - start} are there"
            )
        chunks.setdefault(kind, whole[start : start + length])
        start += length
    if b"JSON" not in chunks:
        raise MeshError("it has no chunk of JSON, as a GLB has")
    return bytes(chunks[b"JSON"]), chunks.get(b"BIN\0")


def _decoded(text: bytes) -> str:
    # Several programs fill the chunk up with NUL instead of blanks.
    text = text.rstrip(b"\0 \t\r\n")
    try:
        return text.decode(json.detect_encoding(text), "surrogatepass")
    except UnicodeDecodeError:
        return text.decode("latin-1")


def _parsed(text: str) -> dict[str, Any]:
    tree = json.loads(text)
    if not isinstance(tree, dict):
        raise MeshError("its JSON is no object")
    return tree


def _decoded_address(address: str) -> bytes:
    """Return the bytes that a ``data:`` address holds (RFC 2397)."""
    kind, _, data = address.partition(",")
    if kind.endswith(";base64"):
        # `base64.b64decode` would copy the text.
        return binascii.a2b_base64(unquote(data) if "%" in data else data)
    return unquote_to_bytes(data)


def _shares(stored: NDArray[Any]) -> FloatArray:
    if stored.dtype.kind == "f":
        return stored.astype(np.float64)
    return np.maximum(stored / float(np.iinfo(stored.dtype).max), -1.0)
