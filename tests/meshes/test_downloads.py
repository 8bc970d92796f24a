"""Models come whole, checked, and without trust in what an archive says."""

import hashlib
import http.server
import io
import tarfile
import threading
from dataclasses import replace
from typing import ClassVar

import pytest
from meshes.generated import packed

from visuohaptic.errors import DownloadError
from visuohaptic.geometry.surface import read_surface
from visuohaptic.meshes import downloads
from visuohaptic.meshes.catalogue import Credit, Model
from visuohaptic.meshes.downloads import (
    LIBRARY_FOLDER,
    download,
    extract_libraries,
    fetch_models,
    pack_model,
    read_member,
    write_credits,
)

OBJ = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"
MODEL = Model(
    "cup", "mug", "Some.sh3f", "some/mug/mug.obj", hashlib.sha256(OBJ).hexdigest(),
    credit=Credit("A. Maker", "CC0-1.0", ""),
)  # fmt: skip


def debian_package(members):
    tar = io.BytesIO()
    with tarfile.open(fileobj=tar, mode="w:xz") as data:
        for name, content in members.items():
            info = tarfile.TarInfo(name)
            info.size = len(content)
            data.addfile(info, io.BytesIO(content))

    def entry(name, content):
        header = f"{name:<16}{0:<12}{0:<6}{0:<6}{100644:<8}{len(content):<10}`\n".encode()
        return header + content + b"\n" * (len(content) % 2)

    return b"!<arch>\n" + entry("debian-binary", b"2.0\n") + entry("data.tar.xz", tar.getvalue())


@pytest.fixture
def library(tmp_path):
    path = tmp_path / "Some.sh3f"
    path.write_bytes(packed({MODEL.member: OBJ, "../../evil.obj": b"x"}))
    return path


class ArchiveServer(http.server.BaseHTTPRequestHandler):
    """Serves one content; counts how often it was asked."""

    content = bytes(range(256)) * 4000
    asked: ClassVar[list] = []

    def do_GET(self):
        self.asked.append(self.path)
        self.send_response(200)
        self.send_header("Content-Length", str(len(self.content)))
        self.end_headers()
        self.wfile.write(self.content)

    def log_message(self, *arguments):
        pass


@pytest.fixture
def address():
    ArchiveServer.asked = []
    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), ArchiveServer)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    yield f"http://127.0.0.1:{server.server_port}/archive"
    server.shutdown()
    server.server_close()


SHA256 = hashlib.sha256(ArchiveServer.content).hexdigest()


def test_a_download_is_whole_and_checked(address, tmp_path):
    path = download(address, tmp_path / "a.zip", SHA256)
    assert path.read_bytes() == ArchiveServer.content
    assert [file.name for file in tmp_path.iterdir()] == ["a.zip"]


def test_a_file_that_is_there_is_not_asked_for_again(address, tmp_path):
    (tmp_path / "a.zip").write_bytes(ArchiveServer.content)
    download(address, tmp_path / "a.zip", SHA256)
    assert ArchiveServer.asked == []


def test_a_download_with_another_hash_is_thrown_away(address, tmp_path):
    with pytest.raises(
        DownloadError, match="has not the pinned SHA-256 0000; nothing of it was used"
    ):
        download(address, tmp_path / "a.zip", "0000")
    assert list(tmp_path.iterdir()) == []


def test_a_download_that_is_too_large_is_refused_and_not_kept(address, tmp_path, monkeypatch):
    monkeypatch.setattr(downloads, "_LARGEST_ARCHIVE_BYTES", 1000)
    with pytest.raises(DownloadError, match="that is not the pinned archive"):
        download(address, tmp_path / "a.zip", SHA256)
    assert list(tmp_path.iterdir()) == []


def test_a_server_that_is_not_there_is_named(tmp_path):
    with pytest.raises(DownloadError, match="can't be downloaded"):
        download("http://127.0.0.1:9/x", tmp_path / "a.zip", SHA256)


def test_libraries_come_out_of_a_debian_package_by_exact_name(tmp_path):
    package = tmp_path / "a.deb"
    package.write_bytes(
        debian_package({f"./{LIBRARY_FOLDER}/Some.sh3f": b"library", "./../../evil": b"x"})
    )
    (tmp_path / "out").mkdir()
    extract_libraries(package, {"Some.sh3f": tmp_path / "out" / "Some.sh3f"})
    assert (tmp_path / "out" / "Some.sh3f").read_bytes() == b"library"
    assert sorted(file.name for file in tmp_path.rglob("*")) == ["Some.sh3f", "a.deb", "out"]


@pytest.mark.parametrize(
    ("content", "sentence"),
    [
        (b"<html>", "is no Debian package"),
        (b"!<arch>\n", "has no data"),
        (debian_package({"./other": b"x"}), "lacks ./usr/share/sweethome3d/furniture/Some.sh3f"),
        (debian_package({"./other": b"x" * 5000})[:-60], "can't be unpacked"),
    ],
)
def test_a_broken_package_is_named(tmp_path, content, sentence):
    package = tmp_path / "a.deb"
    package.write_bytes(content)
    with pytest.raises(DownloadError, match=sentence):
        extract_libraries(package, {"Some.sh3f": tmp_path / "Some.sh3f"})
    assert not (tmp_path / "Some.sh3f").exists()


def test_a_model_is_packed_as_a_surface(library, tmp_path):
    path = pack_model(MODEL, library, tmp_path / "out")
    assert path == tmp_path / "out" / "cup" / "mug.ply.gz"
    assert len(read_surface(path).faces) == 1


def test_a_model_with_another_hash_is_refused(library, tmp_path):
    with pytest.raises(DownloadError, match="beef is pinned"):
        pack_model(replace(MODEL, sha256="beef"), library, tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_a_member_that_is_not_there_or_too_large_is_refused(library):
    with pytest.raises(DownloadError, match=r"has no member gone\.obj"):
        read_member(library, "gone.obj", 100)
    with pytest.raises(DownloadError, match="unpacks to more than"):
        read_member(library, MODEL.member, 3)


def test_an_archive_that_is_none_is_named(tmp_path):
    (tmp_path / "a.zip").write_bytes(b"hello")
    with pytest.raises(DownloadError, match=r"a\.zip can't be read"):
        read_member(tmp_path / "a.zip", "x", 10)


def test_models_come_from_libraries_that_are_there_already(library, tmp_path):
    fetch_models([MODEL], tmp_path / "out", library.parent)
    assert (tmp_path / "out" / "cup" / "mug.ply.gz").exists()


def test_credits_name_every_author(tmp_path):
    write_credits([MODEL, Model("own", "thing")], tmp_path / "credits.csv")
    assert (tmp_path / "credits.csv").read_text().splitlines()[1:] == ["cup,mug,A. Maker,CC0-1.0,"]
