"""A member of a zip archive takes the memory of its limit, whatever size the archive's directory states."""

import io
import tracemalloc
import zipfile

import pytest

from meshreaders.base.archives import count_members, read_member

LARGE = 64 * 10**6


def lying(size, stated):
    """An archive whose directory states another size than that of its member of `size` zeros."""
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("a", bytes(size))
    written = size.to_bytes(4, "little")
    assert packed.getvalue().count(written) == 2
    return zipfile.ZipFile(
        io.BytesIO(packed.getvalue().replace(written, stated.to_bytes(4, "little")))
    )


def peak_of(work):
    tracemalloc.start()
    try:
        work()
        return tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()


def test_a_member_that_is_larger_than_the_directory_states_takes_little_memory():
    def refused(read):
        with pytest.raises(zipfile.BadZipFile, match="CRC"):
            read()

    with lying(LARGE, 1000) as archive:
        assert peak_of(lambda: refused(lambda: archive.read("a"))) > LARGE
        assert peak_of(lambda: refused(lambda: read_member(archive, "a", LARGE))) < LARGE / 10


def test_a_member_is_read_to_its_end_or_to_one_byte_more_than_is_allowed():
    with lying(LARGE, LARGE) as archive:
        assert len(read_member(archive, "a", LARGE)) == LARGE
        peak = peak_of(lambda: len(read_member(archive, "a", 1000)) == 1001)
        assert len(read_member(archive, archive.infolist()[0], 1000)) == 1001
    assert peak < LARGE / 10


def test_members_are_counted_before_the_archive_is_opened():
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w") as archive:
        for number in range(30):
            archive.writestr(f"{number}", b"")
    assert count_members(packed.getvalue()) == 30
