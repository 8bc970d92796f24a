"""Only regular files are opened, so that nothing waits for a pipe or reads a device without end."""

import os
import socket
from pathlib import Path

import pytest

from meshreaders.base.regular_files import check_regular, open_regular, read_regular


@pytest.fixture
def pipe(tmp_path):
    os.mkfifo(tmp_path / "pipe")
    return tmp_path / "pipe"


@pytest.mark.parametrize("read", [check_regular, open_regular, lambda path: read_regular(path, 9)])
def test_a_pipe_is_refused_and_not_waited_for(pipe, read):
    with pytest.raises(OSError, match="it is a pipe, and a regular file is needed") as refusal:
        read(pipe)
    assert refusal.value.filename == str(pipe)


def test_sockets_devices_and_folders_are_refused(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with socket.socket(socket.AF_UNIX) as bound:
        bound.bind("socket")
        for name, says in (("socket", "a socket"), ("/dev/zero", "a device"), (".", "Is a dir")):
            with pytest.raises(OSError, match=says):
                open_regular(name)
    with pytest.raises(FileNotFoundError, match="gone"):
        open_regular("gone")


def test_a_file_and_a_link_to_a_file_are_opened(tmp_path):
    (tmp_path / "file").write_bytes(b"content")
    (tmp_path / "link").symlink_to("file")
    for path in (tmp_path / "file", str(tmp_path / "link")):
        with open_regular(path) as stream:
            assert stream.read() == b"content"
        assert read_regular(path, 7) == b"content"
        with pytest.raises(OSError, match="it is larger than 6e-06 MB"):
            read_regular(path, 6)


def test_a_link_to_a_pipe_is_refused(pipe):
    Path(f"{pipe}.obj").symlink_to(pipe)
    with pytest.raises(OSError, match="it is a pipe"):
        open_regular(f"{pipe}.obj")
