"""Read a mesh from a path, an open file or an object in memory as a coloured surface."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, TypeAlias
from zipfile import ZipFile

from meshreaders.base import errors
from meshreaders.companions import ArchiveCompanions
from meshreaders.reading import Source as MeshSource
from meshreaders.reading import name_of, read, read_data
from visuohaptic.base.errors import MeshError
from visuohaptic.geometry.surface import Surface, read_surface

if TYPE_CHECKING:
    from meshreaders.base.mesh import Mesh

Source: TypeAlias = MeshSource
"""Types of sources of a mesh: those of `meshreaders.read`, which include a `Surface`."""

PACKED = ".ply.gz"
"""Suffix of files that `write_surface` writes."""


def read_mesh(
    source: Source, file_type: str | None = None, largest_megabytes: float = 512.0
) -> Surface:
    """Read a mesh from any source, and join all its parts to one surface with colours and images.

    Parameters
    ----------
    source : path, binary file, trimesh.Trimesh or Scene, open3d TriangleMesh, pyvista.PolyData, (vertices, faces) or Surface
        The mesh, as `meshreaders.read` takes it. A path may also name a packed surface, ``.ply.gz``. A `Surface` is
        returned unchanged.
    file_type : str, optional
        Format of an open file, such as ``obj``; by default the suffix of its name. Ignored for other sources.
    largest_megabytes : float
        Largest size of a file, in 10⁶ bytes; of a packed surface, the size after unpacking.

    Returns
    -------
    Surface
        Vertices, colours, images and notes as of `meshreaders.read`, in the frame and unit of the source.

    Raises
    ------
    MeshError
        If the source has another type, can't be read, or has no triangle; also if a buffer of a glTF file is missing.
    """
    if isinstance(source, Surface):
        return source
    if isinstance(source, str | Path) and str(source).endswith(PACKED):
        return read_surface(source, largest_megabytes)
    try:
        return _surface(read(source, file_type, largest_megabytes))
    except errors.TooLargeError as error:
        sentence = f"{name_of(source)} is too large; {largest_megabytes:g} MB are allowed"
        raise MeshError(f"{sentence} (meshes.largest_megabytes).") from error
    except errors.MeshError as error:
        raise MeshError(str(error)) from error


def surface_from_archive(data: bytes, name: str, archive: ZipFile) -> Surface:
    """Read the content `data` of a member of a zip archive of the catalogue as a surface.

    `name` is the path of the member in the archive, with the suffix of a model file. Files that the member refers to
    are read from the same folder of the archive and below. Surfaces of the catalogue are pinned, so polygons are cut
    as they were for them: some lack corners. Raises `MeshError` if the content is broken.
    """
    companions = ArchiveCompanions(archive, name)
    companions.keep_corners = False
    try:
        return _surface(read_data(data, Path(name).suffix[1:], name, companions))
    except errors.MeshError as error:
        raise MeshError(str(error)) from error


def _surface(mesh: Mesh) -> Surface:
    return Surface(
        mesh.vertices, mesh.faces, mesh.face_colours, mesh.texture, mesh.notes, mesh.up_axis
    )
