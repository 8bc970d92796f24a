"""Download the models of the catalogue, and write each as a coloured surface.

With apt, models come from a Debian package, otherwise from the upstream archives. Archives are not unpacked to disk.
Members are read by their names in the catalogue. Their size is limited, and their digest is checked.
"""

from __future__ import annotations

import hashlib
import logging
import re
import shutil
import subprocess
import tarfile
import zipfile
import zlib
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import pooch
import requests
from joblib import Parallel, delayed
from tqdm import tqdm

from meshreaders.base.archives import read_member as read_bounded
from visuohaptic.base.atomic_files import atomic_file, storage_fault
from visuohaptic.base.errors import DownloadError, StorageError
from visuohaptic.geometry.surface import write_surface
from visuohaptic.meshes.catalogue import Model
from visuohaptic.meshes.model_files import surface_from_archive

DEBIAN_PACKAGE = "sweethome3d-furniture"
DEBIAN_SHA256 = "3ccb90c63f9525e887a767b9cd5c8b6933b8b6b2973a615a5359ee68a2118668"
UPSTREAM = (
    "https://sourceforge.net/projects/sweethome3d/files/SweetHome3D-models/"
    "3DModels-1.8/3DModels-{library}-1.8.zip/download"
)
LIBRARY_FOLDER = "usr/share/sweethome3d/furniture"

_LARGEST_ARCHIVE_BYTES = 400 * 10**6
_LARGEST_MEMBER_BYTES = 100 * 10**6
_BLOCK_BYTES = 10**6


def fetch_models(
    models: Sequence[Model], folder: str | Path, cache: str | Path, jobs: int = 1
) -> None:
    """Download missing models and write each as `<folder>/<class>/<name>.ply.gz`, in `jobs` processes.

    Raises `DownloadError` if an archive can't be downloaded, or a model has another digest than in the catalogue.
    """
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    missing = [model for model in models if not (folder / f"{model.key}.ply.gz").exists()]
    libraries = fetch_libraries(sorted({model.library for model in missing}), cache)
    tasks = (delayed(pack_model)(model, libraries[model.library], folder) for model in missing)
    packed = Parallel(n_jobs=jobs, return_as="generator")(tasks)
    for _ in tqdm(packed, total=len(missing), desc="packing models", unit="model", disable=None):
        pass


def fetch_libraries(libraries: Sequence[str], cache: str | Path) -> dict[str, Path]:
    """Download missing furniture libraries, such as ``Scopia.sh3f``, into a cache folder; return their paths."""
    cache = Path(cache)
    cache.mkdir(parents=True, exist_ok=True)
    paths = {library: cache / Path(library).name for library in libraries}
    missing = {library: path for library, path in paths.items() if not path.exists()}
    if not missing:
        return paths
    address = _debian_address()
    if address is not None:
        package = download(address, cache / f"{DEBIAN_PACKAGE}.deb", DEBIAN_SHA256)
        extract_libraries(package, missing)
        return paths
    for library, path in missing.items():
        stem = library.removesuffix(".sh3f")
        archive = download(UPSTREAM.format(library=stem), cache / f"{stem}.zip")
        with atomic_file(path) as unpacked:
            unpacked.write_bytes(read_member(archive, library, _LARGEST_ARCHIVE_BYTES))
    return paths


def download(address: str, path: Path, sha256: str | None = None) -> Path:
    """Download a file unless it exists; the file appears only if it is complete and has the given digest."""
    pooch.get_logger().setLevel(logging.WARNING)
    known_hash = f"sha256:{sha256}" if sha256 else None
    try:
        pooch.retrieve(address, known_hash, path.name, path.parent, downloader=_download_bounded)
    except (requests.RequestException, OSError) as error:
        if fault := storage_fault(error, path):
            raise fault from error
        raise DownloadError(f"{address} can't be downloaded: {error}; run again.") from error
    except ValueError as error:
        raise DownloadError(
            f"{address} does not have the pinned SHA-256 {sha256}; the file was not used, run again."
        ) from error
    return path


def _download_bounded(address: str, path: str, _: object) -> None:
    """Download a file; raise `DownloadError` above `_LARGEST_ARCHIVE_BYTES`."""
    with requests.get(address, stream=True, timeout=60) as answer, Path(path).open("wb") as stream:
        answer.raise_for_status()
        for block in tqdm(answer.iter_content(_BLOCK_BYTES), unit="MB", disable=None):
            stream.write(block)
            if stream.tell() > _LARGEST_ARCHIVE_BYTES:
                raise DownloadError(
                    f"{address} has more than {_LARGEST_ARCHIVE_BYTES / 1e6:.0f} MB and is not the "
                    "pinned archive."
                )


def extract_libraries(package: Path, libraries: Mapping[str, Path]) -> None:
    """Extract furniture libraries from a ``.deb`` with dpkg; each file is written whole or not at all.

    Raises `DownloadError` if `package` is no Debian package, or lacks a library.
    """
    wanted = {f"./{LIBRARY_FOLDER}/{library}": path for library, path in libraries.items()}
    command = ["dpkg-deb", "--fsys-tarfile", str(package)]
    try:
        with (
            subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL) as dpkg,  # noqa: S603 - a fixed command
            tarfile.open(fileobj=dpkg.stdout, mode="r|") as data,
        ):
            for member in data:
                if member.isreg() and member.name in wanted:
                    if member.size > _LARGEST_ARCHIVE_BYTES:
                        raise DownloadError(
                            f"{package}: {member.name} unpacks to more than "
                            f"{_LARGEST_ARCHIVE_BYTES / 1e6:.0f} MB."
                        )
                    stream = data.extractfile(member)
                    if stream is not None:
                        with atomic_file(wanted.pop(member.name)) as unpacked:
                            unpacked.write_bytes(stream.read())
    except StorageError:
        raise
    except (tarfile.TarError, OSError) as error:
        raise DownloadError(
            f"{package} can't be unpacked: {error}; delete it and run again."
        ) from error
    if wanted:
        raise DownloadError(
            f"{package} lacks {', '.join(sorted(wanted))}; another version is needed."
        )


def pack_model(model: Model, library: Path, folder: Path) -> Path:
    """Read a model from its library, check its digest, and write it as a coloured surface; return the path."""
    data = read_member(library, model.member, _LARGEST_MEMBER_BYTES)
    sha256 = hashlib.sha256(data).hexdigest()
    if sha256 != model.sha256:
        raise DownloadError(
            f"{library}: {model.member} has the SHA-256 {sha256}; {model.sha256} is pinned."
        )
    with zipfile.ZipFile(library) as archive:
        surface = surface_from_archive(data, model.member, archive)
    # Users can't mend a pinned archive, so notes on it are dropped.
    surface = replace(surface, notes=())
    path = folder / f"{model.key}.ply.gz"
    write_surface(surface, path)
    return path


def read_member(archive: Path, member: str, largest_bytes: int) -> bytes:
    """Return a member of a zip archive; raise `DownloadError` if the member is missing or too large."""
    try:
        with zipfile.ZipFile(archive) as opened:
            data = read_bounded(opened, member, largest_bytes)
    except KeyError as error:
        raise DownloadError(f"{archive} has no member {member}.") from error
    # zipfile raises RuntimeError for encrypted members, and NotImplementedError for unknown compression.
    except (zipfile.BadZipFile, OSError, RuntimeError, EOFError, zlib.error) as error:
        raise DownloadError(
            f"{archive} can't be read: {error}; delete it and run again."
        ) from error
    if len(data) > largest_bytes:
        raise DownloadError(
            f"{archive}: {member} unpacks to more than {largest_bytes / 1e6:.0f} MB."
        )
    return data


def _debian_address() -> str | None:
    """Return the address of the package from apt; None without apt, or if apt does not know the pinned package."""
    apt = shutil.which("apt-get")
    if apt is None:
        return None
    answer = subprocess.run(  # noqa: S603 - a fixed command
        [apt, "--print-uris", "download", DEBIAN_PACKAGE],
        capture_output=True,
        text=True,
        check=False,
    )
    address = re.search(r"^'(https?://[^']+)'.*SHA256:(\w+)", answer.stdout, re.MULTILINE)
    return address[1] if address and address[2] == DEBIAN_SHA256 else None
