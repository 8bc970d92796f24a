"""Read triangle meshes with their colours and images: OBJ, PLY, STL, OFF, glTF, 3MF, COLLADA, and meshes in memory.

``mesh = meshreaders.read("chair.glb")`` returns vertices, triangles, colours or a texture, and notes.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from meshreaders.base.errors import MeshError, MissingPackageError, TooLargeError
    from meshreaders.base.mesh import Mesh
    from meshreaders.base.suffixes import COMPANION_SUFFIXES, MODEL_SUFFIXES
    from meshreaders.base.texture import Texture
    from meshreaders.parts import Part
    from meshreaders.reading import Parts, Source, read, read_parts
    from meshreaders.textures import Paint
    from meshreaders.trimesh_export import to_trimesh

__version__ = "0.2.0"

__all__ = [
    "COMPANION_SUFFIXES",
    "MODEL_SUFFIXES",
    "Mesh",
    "MeshError",
    "MissingPackageError",
    "Paint",
    "Part",
    "Parts",
    "Source",
    "Texture",
    "TooLargeError",
    "read",
    "read_parts",
    "to_trimesh",
]

# Names are imported on first use, so that a program that needs only some modules does not load all readers.
_MODULES = {
    "COMPANION_SUFFIXES": "base.suffixes",
    "MODEL_SUFFIXES": "base.suffixes",
    "Mesh": "base.mesh",
    "MeshError": "base.errors",
    "MissingPackageError": "base.errors",
    "Paint": "textures",
    "Part": "parts",
    "Parts": "reading",
    "Source": "reading",
    "Texture": "base.texture",
    "TooLargeError": "base.errors",
    "read": "reading",
    "read_parts": "reading",
    "to_trimesh": "trimesh_export",
}


def __getattr__(name: str) -> Any:
    if name not in _MODULES:
        raise AttributeError(f"module 'meshreaders' has no attribute {name!r}")
    return getattr(import_module(f"meshreaders.{_MODULES[name]}"), name)


def __dir__() -> list[str]:
    return [*__all__, "__version__"]
