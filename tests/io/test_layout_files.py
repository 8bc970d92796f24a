"""Files of taxels."""

import numpy as np
import pytest

from visuohaptic.base.errors import ParameterError
from visuohaptic.io.layout_files import read_layout

HEADER = "x,y,z,direction_x,direction_y,direction_z"


def file_of(tmp_path, text):
    path = tmp_path / "pad.csv"
    path.write_text(text)
    return path


def test_columns_may_be_in_any_order_beside_others(tmp_path):
    path = file_of(
        tmp_path, "name,z,y,x,direction_z,direction_x,direction_y\na,0,0,1,-1,0,0\nb,0,2,0,-2,0,0\n"
    )
    layout = read_layout(path, unit="cm")
    np.testing.assert_allclose(layout.positions, [[0.5, 0, 0], [0, 1, 0]])
    np.testing.assert_allclose(layout.directions, [[0, 0, -1]] * 2)
    assert (layout.name, layout.half_width_m) == ("pad.csv", 0.02)


def test_semicolons_with_decimal_commas_are_read(tmp_path):
    path = file_of(tmp_path, HEADER.replace(",", ";") + "\n0,5;0;0;0;0;-1\n-0,25;0,125;0;0;0;-1\n")
    np.testing.assert_allclose(read_layout(path).positions, [[1, 0, 0], [-0.5, 0.25, 0]])


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("x,y,z\n1,0,0\n", "pad.csv has 0 columns direction_x; x, y, z, .* each once, in a header"),
        (HEADER + "\n1,0,0,0,0,nan\n", "direction_z is 'nan': a finite number is needed"),
        (HEADER + "\n1,0,0,0,0,down\n", "direction_z is 'down': a number is needed"),
        (HEADER + "\n1,0,0,0,0,0\n", r"pad.csv: taxel 0 has the direction \(0, 0, 0\)"),
        (HEADER + "\n1,0,0,0,0,-1\n1,0,0,0,0,-1\n", "taxels 0 and 1 are both at"),
        ("1,0,0,0,0,-1.0\n", "has 0 columns x"),
        ("", "holds no rows"),
    ],
)
def test_a_file_that_is_not_allowed_is_refused_in_a_sentence(tmp_path, text, says):
    with pytest.raises(ParameterError, match=says):
        read_layout(file_of(tmp_path, text))


def test_a_million_rows_and_a_missing_file_are_refused(tmp_path):
    rows = "\n".join(f"{row},0,0,0,0,-1" for row in range(100_001))
    with pytest.raises(ParameterError, match="more than 100,000 rows"):
        read_layout(file_of(tmp_path, f"{HEADER}\n{rows}\n"))
    with pytest.raises(ParameterError, match=r"none\.csv can't be read"):
        read_layout(tmp_path / "none.csv")
