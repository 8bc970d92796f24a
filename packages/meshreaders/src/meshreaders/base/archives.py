"""Reading of zip archives whose directories may be wrong about the size of members."""

from __future__ import annotations

from zipfile import ZipFile, ZipInfo

from meshreaders.base.regular_files import read_bounded

_MEMBER = b"PK\x01\x02"  # begins the record of a member in the archive's directory


def count_members(data: bytes) -> int:
    """Return an upper bound of the number of members of a zip archive.

    `zipfile.ZipFile` takes some 600 bytes per member when it opens an archive. A member of the archive may have only
    46 bytes.
    """
    return data.count(_MEMBER)


def read_member(archive: ZipFile, member: ZipInfo | str, most_bytes: int) -> bytes:
    """Return the first `most_bytes` + 1 bytes of a member of a zip archive; fewer if the member is shorter.

    A longer result than `most_bytes` means that the member is too large. Reading takes the memory of the result and a
    megabyte, whatever size the archive's directory states. Raises the errors of `zipfile.ZipFile.open` and of its
    streams, such as `zipfile.BadZipFile` if the content does not fit its checksum.
    """
    with archive.open(member) as stream:
        # `ZipFile.read` would unpack up to 2 GiB at once, and then cut the result to the stated size.
        return read_bounded(stream, most_bytes)
