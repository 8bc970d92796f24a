"""The tables of a PLY file are those that plyfile reads, whatever types and lengths its lists have."""

import io

import numpy as np
import pytest
from plyfile import PlyData, PlyElement, PlyParseError

from meshreaders.base.errors import MeshError
from meshreaders.base.ply_header import read_ply_header
from meshreaders.formats.ply_tables import read_tables

NUMBERS = ["i1", "u1", "i2", "u2", "i4", "u4", "f4", "f8"]
LENGTHS = ["i1", "u1", "i2", "u2", "i4", "u4"]


COLUMNS = {"uneven": ["a"], "last": ["x", "y"]}


def numbers(random, count, kind):
    return random.integers(0, 100, count).astype(kind)


def written(seed, order, rows=3000, longest=7):
    """An element with two columns and two lists of random types and lengths, between two other elements."""
    random = np.random.default_rng(seed)
    kinds = random.choice(NUMBERS, 4).tolist()
    table = np.empty(rows, [("a", kinds[0]), ("b", "O"), ("c", kinds[1]), ("d", "O")])
    for name, kind in (("a", kinds[0]), ("c", kinds[1])):
        table[name] = numbers(random, rows, kind)
    for name, kind in (("b", kinds[2]), ("d", kinds[3])):
        lengths = random.integers(0, longest, rows)
        # A row of this list is longer than a block.
        lengths[rows // 2] = 20_000 if name == "d" else 100
        table[name] = [numbers(random, length, kind) for length in lengths]
    lengths = dict(zip("bd", [str(random.choice(LENGTHS)), "i4"], strict=True))
    even = np.array([(1, 2.5), (3, 4.5)], [("x", "i2"), ("y", "f8")])
    elements = [
        PlyElement.describe(even, "first"),
        PlyElement.describe(
            table, "uneven", len_types=lengths, val_types={"b": kinds[2], "d": kinds[3]}
        ),
        PlyElement.describe(even, "last"),
    ]
    stream = io.BytesIO()
    PlyData(elements, text=order == "text", byte_order="<" if order == "text" else order).write(
        stream
    )
    return stream.getvalue()


def same(found, expected):
    native = expected.astype(expected.dtype.newbyteorder("="))
    np.testing.assert_array_equal(found, native, strict=True)


# plyfile warns of an empty list of text.
@pytest.mark.filterwarnings("ignore:loadtxt")
@pytest.mark.parametrize("order", ["<", ">", "text"])
@pytest.mark.parametrize("seed", range(8))
def test_lists_of_any_lengths_are_those_that_plyfile_reads(seed, order):
    data = written(seed, order)
    tables = read_tables(data, read_ply_header(data), COLUMNS)
    assert list(tables) == ["uneven", "last"]
    for element in PlyData.read(io.BytesIO(data)).elements[1:]:
        table = tables[element.name]
        assert table.rows == len(element.data)
        for name, column in table.columns.items():
            same(column, element.data[name])
        for name, lists in table.lists.items():
            same(lists.counts, np.array([len(row) for row in element.data[name]], np.int32))
            same(lists.values, np.concatenate(element.data[name]))
    assert set(tables["uneven"].columns) == {"a"}
    assert set(tables["uneven"].lists) == {"b", "d"}


@pytest.mark.parametrize("cut", [1, 40, 4000])
def test_a_truncated_row_is_named_by_its_element(cut):
    data = written(0, "<")
    # The last element has two rows of ten bytes.
    says = {1: "'last', and 1 are", 40: "'uneven', and 2999 are", 4000: "'uneven', and 28.. are"}
    with pytest.raises((MeshError, PlyParseError), match=says[cut]):
        read_tables(data[:-cut], read_ply_header(data), COLUMNS)
