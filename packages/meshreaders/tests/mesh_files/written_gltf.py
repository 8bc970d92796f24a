"""Write glTF files by hand, each number as the specification has it, to compare with what is read."""

import base64
import io
import json
import struct

import numpy as np
from PIL import Image

TYPES = {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4", 16: "MAT4"}
COMPONENTS = {"i1": 5120, "u1": 5121, "i2": 5122, "u2": 5123, "u4": 5125, "f4": 5126}
CUBE = np.indices((2, 2, 2)).reshape(3, -1).T.astype("f4")
CUBE_FACES = np.array(
    [[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1],
     [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]], dtype="u2",
)  # fmt: skip


class Gltf:
    """A glTF file in the making: one buffer, into which arrays are put one behind another."""

    def __init__(self):
        self.data = b""
        self.tree = {"asset": {"version": "2.0"}, "accessors": [], "bufferViews": []}

    def view(self, data, **more):
        self.data += b"\0" * (-len(self.data) % 4)
        self.tree["bufferViews"].append(
            {"buffer": 0, "byteOffset": len(self.data), "byteLength": len(data), **more}
        )
        self.data += data
        return len(self.tree["bufferViews"]) - 1

    def put(self, rows, normalized=False, gap=0):
        """Put an array (n, k), its rows with a gap of bytes between them, and return its accessor."""
        rows = np.asarray(rows)
        rows = rows.reshape(len(rows), -1)
        data, more = rows.astype(rows.dtype.newbyteorder("<")).tobytes(), {}
        if gap:
            padded = np.full((len(rows), len(data) // len(rows) + gap), 0xAB, np.uint8)
            padded[:, :-gap] = np.frombuffer(data, np.uint8).reshape(len(rows), -1)
            data, more = padded.tobytes(), {"byteStride": padded.shape[1]}
        accessor = {
            "bufferView": self.view(data, **more),
            "componentType": COMPONENTS[rows.dtype.str[1:]],
            "count": len(rows),
            "type": TYPES[rows.shape[1]],
        }
        if normalized:
            accessor["normalized"] = True
        return self.add("accessors", accessor)

    def add(self, kind, entry):
        self.tree.setdefault(kind, []).append(entry)
        return len(self.tree[kind]) - 1

    def mesh(self, vertices=CUBE, faces=CUBE_FACES, attributes=(), **more):
        """Add a mesh of one primitive, and return its number."""
        primitive = {"attributes": {"POSITION": self.put(np.float32(vertices)), **dict(attributes)}}
        if faces is not None:
            primitive["indices"] = self.put(np.ravel(faces))
        return self.add("meshes", {"primitives": [{**primitive, **more}]})

    def image(self, pixels):
        """Add an image as a buffer view, and return its number."""
        stream = io.BytesIO()
        Image.fromarray(pixels).save(stream, "PNG")
        return self.add(
            "images", {"bufferView": self.view(stream.getvalue()), "mimeType": "image/png"}
        )

    def show(self, *nodes):
        """Add nodes, the roots of the scene."""
        self.tree["scenes"] = [{"nodes": [self.add("nodes", node) for node in nodes]}]
        self.tree["scene"] = 0
        return self

    def text(self, **values):
        """Return the file as .gltf, with other values of its top level in it."""
        uri = "data:application/octet-stream;base64," + base64.b64encode(self.data).decode()
        buffers = [{"uri": uri, "byteLength": len(self.data)}]
        return json.dumps({**self.tree, "buffers": buffers, **values}).encode()

    def binary(self, fill=b" ", behind=b"", **values):
        """Return the file as .glb, its JSON filled up to four bytes by `fill`, with bytes behind its end."""
        text = json.dumps({**self.tree, "buffers": [{"byteLength": len(self.data)}], **values})
        data = text.encode() + fill * (-len(text) % 4)
        chunks = [(b"JSON", data), (b"BIN\0", self.data + bytes(-len(self.data) % 4))]
        body = b"".join(struct.pack("<I4s", len(one), kind) + one for kind, one in chunks)
        return struct.pack("<4sII", b"glTF", 2, 12 + len(body)) + body + behind
