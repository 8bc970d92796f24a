"""Models come whole, checked, and without trust in what an archive says."""

import errno
import hashlib
import http.server
import os
import shutil
import subprocess
import threading
import tracemalloc
import zipfile
from dataclasses import replace
from functools import partial
from pathlib import Path

import pytest
from mesh_files.generated import packed

from visuohaptic.base.errors import DownloadError, StorageError
from visuohaptic.geometry.surface import read_surface
from visuohaptic.meshes import downloads
from visuohaptic.meshes.catalogue import Credit, Model, read_credits, write_credits
from visuohaptic.meshes.downloads import (
    LIBRARY_FOLDER,
    download,
    extract_libraries,
    fetch_models,
    pack_model,
    read_member,
)

OBJ = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"
MODEL = Model(
    "cup", "mug", "Some.sh3f", "some/mug/mug.obj", hashlib.sha256(OBJ).hexdigest(),
    credit=Credit("A. Maker", "CC0-1.0", ""),
)  # fmt: skip


CONTROL = b"Package: a\nVersion: 1\nArchitecture: all\nMaintainer: A <a@b>\nDescription: a\n"


def debian_package(folder, members):
    for name, content in {"DEBIAN/control": CONTROL, **members}.items():
        (folder / "package" / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / "package" / name).write_bytes(content)
    command = ["dpkg-deb", "--build", str(folder / "package"), str(folder / "a.deb")]
    subprocess.run(command, check=True, capture_output=True)
    return folder / "a.deb"


@pytest.fixture
def library(tmp_path):
    path = tmp_path / "Some.sh3f"
    path.write_bytes(packed({MODEL.member: OBJ, "../../evil.obj": b"x"}))
    return path


CONTENT = bytes(range(256)) * 4000
SHA256 = hashlib.sha256(CONTENT).hexdigest()


@pytest.fixture
def address(tmp_path_factory):
    folder = tmp_path_factory.mktemp("served")
    (folder / "archive").write_bytes(CONTENT)
    handler = partial(http.server.SimpleHTTPRequestHandler, directory=folder)
    with http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler) as server:
        threading.Thread(target=server.serve_forever, args=[0.01], daemon=True).start()
        yield f"http://127.0.0.1:{server.server_port}/archive"
        server.shutdown()


def test_a_download_is_whole_and_checked_and_not_asked_for_again(address, tmp_path):
    for asked in (address, "http://127.0.0.1:9/x"):
        path = download(asked, tmp_path / "a.zip", SHA256)
        assert path.read_bytes() == CONTENT
        assert [file.name for file in tmp_path.iterdir()] == ["a.zip"]


def test_a_download_with_another_hash_or_too_large_is_thrown_away(address, tmp_path, monkeypatch):
    with pytest.raises(DownloadError, match="0000; the file was not used"):
        download(address, tmp_path / "a.zip", "0000")
    monkeypatch.setattr(downloads, "_LARGEST_ARCHIVE_BYTES", 1000)
    with pytest.raises(DownloadError, match="not the pinned archive"):
        download(address, tmp_path / "a.zip", SHA256)
    with pytest.raises(DownloadError, match="can't be downloaded"):
        download("http://127.0.0.1:9/x", tmp_path / "a.zip", SHA256)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.skipif(shutil.which("dpkg-deb") is None, reason="there is no dpkg")
def test_libraries_come_out_of_a_debian_package_by_exact_name(tmp_path):
    members = {f"{LIBRARY_FOLDER}/Some.sh3f": b"library", "usr/other/Some.sh3f": b"x"}
    package = debian_package(tmp_path, members)
    extract_libraries(package, {"Some.sh3f": tmp_path / "out" / "Some.sh3f"})
    assert [file.read_bytes() for file in (tmp_path / "out").iterdir()] == [b"library"]
    with pytest.raises(DownloadError, match=f"lacks ./{LIBRARY_FOLDER}/Other.sh3f"):
        extract_libraries(package, {"Other.sh3f": tmp_path / "Other.sh3f"})
    for broken in (b"<html>", package.read_bytes()[:-60]):
        package.write_bytes(broken)
        with pytest.raises(DownloadError, match=r"a\.deb can't be unpacked"):
            extract_libraries(package, {"Some.sh3f": tmp_path / "Some.sh3f"})
    assert not list(tmp_path.glob("*.sh3f"))


@pytest.mark.skipif(shutil.which("dpkg-deb") is None, reason="there is no dpkg")
def test_a_full_disk_is_no_reason_to_delete_a_package(tmp_path, monkeypatch):
    def refuse(path, **_):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), str(path))

    package = debian_package(tmp_path, {f"{LIBRARY_FOLDER}/Some.sh3f": b"library"})
    monkeypatch.setattr(Path, "touch", refuse)
    with pytest.raises(
        StorageError, match=r"Some\.sh3f can't be written: No space left on device\.$"
    ):
        extract_libraries(package, {"Some.sh3f": tmp_path / "Some.sh3f"})


def test_a_model_is_packed_from_a_library_that_is_there_already_unless_its_hash_is_another(
    library, tmp_path
):
    with pytest.raises(DownloadError, match="beef is pinned"):
        pack_model(replace(MODEL, sha256="beef"), library, tmp_path / "out")
    assert not (tmp_path / "out").exists()
    fetch_models([MODEL], tmp_path / "out", library.parent)
    assert len(read_surface(tmp_path / "out" / "cup" / "mug.ply.gz").faces) == 1


def test_a_member_that_is_not_there_or_too_large_is_refused(library):
    with pytest.raises(DownloadError, match=r"has no member gone\.obj"):
        read_member(library, "gone.obj", 100)
    with pytest.raises(DownloadError, match="unpacks to more than"):
        read_member(library, MODEL.member, 3)
    library.write_bytes(b"hello")
    with pytest.raises(DownloadError, match=r"Some\.sh3f can't be read"):
        read_member(library, "x", 10)


@pytest.mark.parametrize(("place", "value"), [(8, 1), (10, 99)])
def test_a_member_that_is_encrypted_or_of_an_unknown_compression_is_refused(library, place, value):
    data = bytearray(library.read_bytes())
    for start, shift in ((data.index(b"PK\x01\x02"), 0), (data.index(b"PK\x03\x04"), -2)):
        data[start + place + shift] = value
    library.write_bytes(data)
    with pytest.raises(DownloadError, match="can't be read"):
        read_member(library, MODEL.member, 100)


def test_a_member_is_read_up_to_the_limit_whatever_its_archive_says_of_its_size(tmp_path):
    content = bytes(10_000_000)
    path = tmp_path / "a.zip"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("a", content)
    tracemalloc.start()
    with pytest.raises(DownloadError, match="unpacks to more than"):
        read_member(path, "a", 1000)
    _, most = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert most < len(content) / 4


def test_credits_name_every_author(tmp_path):
    write_credits([MODEL, Model("own", "thing")], tmp_path / "credits.csv")
    assert (tmp_path / "credits.csv").read_text().splitlines()[1:] == ["cup,mug,A. Maker,CC0-1.0,"]
    assert read_credits([tmp_path / "credits.csv"]) == {"cup/mug": MODEL.credit}
