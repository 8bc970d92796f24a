"""The container of a glTF file: its JSON, and the buffers, accessors and images that the JSON describes.

glTF 2.0 (ISO/IEC 12113:2022), sections 3.4 to 3.8 and 4.4 (GLB).
"""

from __future__ import annotations

import binascii
import json
import struct
from collections.abc import Iterable
from typing import Any
from urllib.parse import unquote, unquote_to_bytes

import numpy as np
from numpy.typing import NDArray

from meshreaders.base.arrays import FloatArray
from meshreaders.base.errors import MeshError
from meshreaders.companions import Companions
from meshreaders.textures import PackedImage, open_image

MOST_IMAGE_BYTES = 512 * 10**6
"""Largest sum of the sizes of packed images; many images may refer to the same bytes."""

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
        # Reflection, refraction or emission of light; the base colour stays the same.
        *(f"KHR_materials_{name}" for name in (
            "anisotropy", "clearcoat", "diffuse_transmission", "dispersion", "emissive_strength", "ior",
            "iridescence", "sheen", "specular", "transmission", "unlit", "volume", "volume_scatter",
        )),
        "VRMC_materials_mtoon", "VRMC_materials_hdr_emissiveMultiplier",
        "MSFT_packing_normalRoughnessMetallic", "MSFT_packing_occlusionRoughnessMetallic",
        # Alternative materials and levels of detail; the default material and shape are read.
        "KHR_materials_variants", "MSFT_lod",
        # Lights, sounds, motion, interaction and metadata.
        "KHR_lights_punctual", "EXT_lights_ies", "EXT_lights_image_based",
        "KHR_audio_emitter", "MSFT_audio_emitter", "KHR_animation_pointer",
        "KHR_node_hoverability", "KHR_node_selectability", "KHR_interactivity",
        "KHR_implicit_shapes", "KHR_physics_rigid_bodies", "OMI_collider", "OMI_physics_body",
        "OMI_physics_shape", "VRM", "VRMC_vrm", "VRMC_springBone", "VRMC_node_constraint",
        "KHR_xmp", "KHR_xmp_json_ld", "AGI_stk_metadata", "EXT_feature_metadata",
        "EXT_instance_features", "EXT_mesh_features", "EXT_structural_metadata",
        "CESIUM_primitive_outline", "GODOT_single_root", "CESIUM_RTC", "EXT_mesh_manifold",
        "MOZ_hubs_components",
    }
)  # fmt: skip
"""Extensions that can change neither a surface nor its base colour."""

PACKED_IMAGES = ("KHR_texture_basisu", "MSFT_texture_dds")
"""Extensions by which a texture has an image of a format that is not read; the surface needs no image."""

DRACO = "KHR_draco_mesh_compression"
"""Extension of compressed primitives. A file that does not require the extension has the plain numbers, too."""

# Extensions of compressed buffer views. A file that does not require them has the plain numbers, too.
_COMPRESSED_VIEWS = ("EXT_meshopt_compression", "KHR_meshopt_compression")
_KNOWN = READ_EXTENSIONS | HARMLESS_EXTENSIONS | {*PACKED_IMAGES, DRACO, *_COMPRESSED_VIEWS}

_COMPONENTS = {5120: "<i1", 5121: "<u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
_WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}
_GLB_HEADER = struct.Struct("<4sII")
_CHUNK_HEADER = struct.Struct("<I4s")
_INLINE = "data:"
_GENERAL_KEYS = {"name", "extras", "extensions"}
_LONGEST_SHOWN = 80


class GltfDocument:
    """A glTF file whose entries are checked when they are used.

    Attributes
    ----------
    tree : dict
        The JSON of the file.
    companions : Companions
        Files that the document refers to.
    worlds : dict of int to ndarray of shape (4, 4)
        The matrix from a node's frame to the scene, per node that was asked for as a joint.
    """

    def __init__(self, data: bytes, companions: Companions) -> None:
        self._size = len(data)
        text, self._chunk = _unpacked(data) if data[:4] == b"glTF" else (data, None)
        self.tree = _parsed(_decoded(text))
        self.companions = companions
        self.worlds: dict[int, FloatArray] = {}
        self._buffers: dict[object, memoryview] = {}
        self._images: dict[object, PackedImage | None] = {}
        self._image_bytes = 0
        self._noted: set[str] = set()
        version = str(self.tree.get("asset", {}).get("version", "2.0"))
        if not version.startswith("2."):
            raise MeshError(f"it is of version {version[:_LONGEST_SHOWN]} of glTF; 2.0 is needed")
        for name in self.tree.get("extensionsRequired", ()):
            if name not in READ_EXTENSIONS | HARMLESS_EXTENSIONS | {*PACKED_IMAGES}:
                raise MeshError(
                    f"it requires the extension {str(name)[:_LONGEST_SHOWN]}, which is not read; export "
                    "it without the extension"
                )

    def entry(self, kind: str, index: Any, label: str) -> dict[str, Any]:
        """Return an entry of a list of the file, such as ``nodes``; `label` names the referring entry in errors."""
        entries = self.tree.get(kind, [])
        if not isinstance(index, int) or not 0 <= index < len(entries):
            raise MeshError(
                f"{label} refers to number {str(index)[:_LONGEST_SHOWN]} of its {kind}; "
                f"{len(entries)} are there, counted from 0"
            )
        entry = entries[index]
        if not isinstance(entry, dict):
            raise MeshError(f"number {index} of its {kind} is no object")
        return entry

    def note_extensions(self, holder: dict[str, Any], label: str) -> None:
        """Note extensions of an entry that are not known, each name once per file.

        A file may be read without an extension that is not in `extensionsRequired` (section 3.12).
        """
        for name in holder.get("extensions", {}):
            if name not in _KNOWN:
                self._note(f"has the optional extension {name[:_LONGEST_SHOWN]}", name, label)

    def note_keys(self, keys: Iterable[str], label: str) -> None:
        """Note keys of an entry that are not read, each once per file; the schema of glTF 2.0 allows further keys."""
        for name in sorted(keys):
            if name not in _GENERAL_KEYS:
                self._note(f"has {name[:_LONGEST_SHOWN]!r}", name, label)

    def _note(self, clause: str, name: str, label: str) -> None:
        if name not in self._noted:
            self._noted.add(name)
            self.companions.notes.append(f"{clause} ({label}), which is not read")

    def count(self, accessor: Any, label: str) -> int:
        """Return the number of rows that an accessor claims; the data may be shorter."""
        described = self.entry("accessors", accessor, label)
        count: int = required(described, "count", int, f"accessor {accessor}")
        if count < 0:
            raise MeshError(f"accessor {accessor} has the count {str(count)[:_LONGEST_SHOWN]}")
        return count

    def stored(self, accessor: int, label: str, *widths: int) -> NDArray[Any]:
        """Return the stored numbers of an accessor, shape (n, k); k must be in `widths`."""
        described = self.entry("accessors", accessor, label)
        self.note_extensions(described, f"accessor {accessor}")
        width = _WIDTHS.get(described.get("type", ""), 0)
        if width not in widths or described.get("componentType") not in _COMPONENTS:
            allowed = [name for name, numbers in _WIDTHS.items() if numbers in widths]
            raise MeshError(
                f"{label} is accessor {accessor}, of {str(described.get('type'))[:9]} and component type "
                f"{str(described.get('componentType'))[:9]}; {' or '.join(allowed)} of a type of glTF 2.0 is needed"
            )
        dtype = np.dtype(_COMPONENTS[described["componentType"]])
        count = self.count(accessor, label)
        if "bufferView" in described:
            rows = self._rows(described, dtype, count, width, f"accessor {accessor}")
        elif "sparse" not in described:
            raise MeshError(f"{label} is accessor {accessor}, which has no data")
        elif count > self._size:
            raise MeshError(f"it claims {count} rows without data in a file of {self._size} bytes")
        else:
            rows = np.zeros((count, width), dtype)
        if "sparse" in described:
            rows = self._patched(rows, described["sparse"], f"accessor {accessor}")
        return rows

    def numbers(self, accessor: int, label: str, *widths: int) -> FloatArray:
        """Return the numbers of an accessor, float64; `normalized` integers become fractions of the largest integer."""
        stored = self.stored(accessor, label, *widths)
        if self.entry("accessors", accessor, label).get("normalized"):
            return _fractions(stored)
        return stored.astype(np.float64)

    def fractions(self, accessor: int, label: str, *widths: int) -> FloatArray:
        """Return the numbers of an accessor, float64; integers become fractions of the largest integer of their type."""
        return _fractions(self.stored(accessor, label, *widths))

    def image(self, index: int, label: str) -> PackedImage | None:
        """Open an image; if that fails, return None and add the reason to `companions.missing`."""
        described = self.entry("images", index, label)
        self.note_extensions(described, f"image {index}")
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
                f"its images are too large together; {MOST_IMAGE_BYTES / 1e6:.0f} MB are allowed"
            )
        image = open_image(data, f"image {index}")
        if image is None:
            kind = str(described.get("mimeType", "no type"))[:_LONGEST_SHOWN]
            self.companions.missing.append(
                f"image {index} ({kind}), which is no image that can be read"
            )
        return image

    def _rows(
        self, described: dict[str, Any], dtype: np.dtype[Any], count: int, width: int, label: str
    ) -> NDArray[Any]:
        index = described["bufferView"]
        data = self._view(index, label)
        row_bytes = width * dtype.itemsize
        stride = self.entry("bufferViews", index, label).get("byteStride") or row_bytes
        start = described.get("byteOffset", 0)
        needed = start + stride * (count - 1) + row_bytes if count else 0
        if stride < row_bytes or start < 0 or needed > len(data):
            raise MeshError(
                f"{label} is truncated: it needs {needed} bytes, in steps of {stride}, of buffer view "
                f"{index}, and {len(data)} are there"
            )
        if not count:
            return np.zeros((0, width), dtype)
        return np.ndarray((count, width), dtype, data, start, (stride, dtype.itemsize))

    def _patched(self, rows: NDArray[Any], sparse: dict[str, Any], label: str) -> NDArray[Any]:
        count = required(sparse, "count", int, label)
        indices, values = (required(sparse, name, dict, label) for name in ("indices", "values"))
        if indices.get("componentType") not in {5121, 5123, 5125}:
            raise MeshError(f"{label} has sparse indices that are no unsigned integers")
        numbers = self._rows(
            indices, np.dtype(_COMPONENTS[indices["componentType"]]), count, 1, label
        )
        if (numbers >= len(rows)).any():
            raise MeshError(f"{label} has a sparse row {numbers.max()}; it has {len(rows)} rows")
        patched = rows.copy()
        patched[numbers[:, 0]] = self._rows(values, rows.dtype, count, rows.shape[1], label)
        return patched

    def _view(self, index: Any, label: str) -> memoryview:
        described = self.entry("bufferViews", index, label)
        self.note_extensions(described, f"buffer view {index}")
        try:
            data = self._buffer(described.get("buffer"), f"buffer view {index}")
        except MeshError as error:
            for name in _COMPRESSED_VIEWS:
                if name in described.get("extensions", {}):
                    raise MeshError(not_read(f"buffer view {index}", name)) from error
            raise
        start, length = described.get("byteOffset", 0), described.get("byteLength", 0)
        if start < 0 or length < 0 or start + length > len(data):
            raise MeshError(
                f"buffer view {index} is truncated: it needs bytes {start} to {start + length}, and "
                f"{len(data)} are there"
            )
        return data[start : start + length]

    def _buffer(self, index: Any, label: str) -> memoryview:
        described = self.entry("buffers", index, label)
        self.note_extensions(described, f"buffer {index}")
        if (described.get("uri") or "").startswith(_INLINE):
            # `pop` frees the address, which is as long as the data.
            self._buffers[index] = memoryview(_decoded_address(described.pop("uri")))
        name = described.get("uri")
        # Several buffers may refer to the same file.
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


def required(holder: dict[str, Any], name: str, kind: type, label: str) -> Any:
    """Return a required value of an entry; raises `MeshError` if the value is missing or of another type."""
    if not isinstance(holder.get(name), kind):
        actual = "none" if name not in holder else type(holder[name]).__name__
        raise MeshError(f"{label} needs {name!r} of type {kind.__name__}, and has {actual}")
    return holder[name]


def not_read(label: str, extension: str) -> str:
    """Return the message on an extension without which an entry has no numbers."""
    return (
        f"{label} has the extension {extension}, which is not read; export it without the extension"
    )


def _unpacked(data: bytes) -> tuple[bytes, memoryview | None]:
    """Return the JSON of a GLB file and its binary chunk, or None without binary chunk."""
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
    start, content = _GLB_HEADER.size, memoryview(data)
    while start + _CHUNK_HEADER.size <= promised:
        length, kind = _CHUNK_HEADER.unpack_from(data, start)
        start += _CHUNK_HEADER.size
        if start + length > promised:
            raise MeshError(
                f"it is truncated: a chunk promises {length} bytes, and {promised - start} are there"
            )
        chunks.setdefault(kind, content[start : start + length])
        start += length
    if b"JSON" not in chunks:
        raise MeshError("it has no chunk of JSON, as a GLB has")
    return bytes(chunks[b"JSON"]), chunks.get(b"BIN\0")


def _decoded(text: bytes) -> str:
    # Several programs pad the chunk with NUL instead of blanks.
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
    """Return the bytes of a ``data:`` address (RFC 2397)."""
    kind, _, data = address.partition(",")
    if kind.endswith(";base64"):
        # `base64.b64decode` would copy the text.
        return binascii.a2b_base64(unquote(data) if "%" in data else data)
    return unquote_to_bytes(data)


def _fractions(stored: NDArray[Any]) -> FloatArray:
    if stored.dtype.kind == "f":
        return stored.astype(np.float64)
    return np.maximum(stored / float(np.iinfo(stored.dtype).max), -1.0)
