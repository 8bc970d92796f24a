"""The lasting names of the readers of users' files are there and read."""

import numpy as np
import pytest
from PIL import Image
from public_files import where


def test_every_lasting_name_is_there():
    for name in where.__all__:
        assert getattr(where, name) is not None, name


def test_a_mesh_and_pictures_are_read_by_their_lasting_names(tmp_path):
    (tmp_path / "a.off").write_text("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n")
    assert where.read_model(tmp_path / "a.off").face_areas.tolist() == [0.5]
    (tmp_path / "cup").mkdir()
    Image.fromarray(np.full((2, 3), 255, np.uint8)).save(tmp_path / "cup/a.png")
    assert where.read_tactile_images(tmp_path).images.tolist() == [[[1.0] * 3] * 2]
    Image.fromarray(np.zeros((2, 3), np.int32)).save(tmp_path / "cup/b.tif")
    with pytest.raises(where.RecognitionError, match=r"b\.tif has whole numbers of 32 bits"):
        where.read_tactile_images(tmp_path)
