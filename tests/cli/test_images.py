"""`visuohaptic images`."""

import json

import numpy as np
from features.pressed_images import pressed, written


def test_a_folder_becomes_a_table_and_is_classified(visuohaptic, tmp_path):
    generator = np.random.default_rng(0)
    for number in range(10):
        for kind, radius in (("small", 2), ("large", 6)):
            centre = generator.uniform(6, 12), generator.uniform(6, 30)
            written(tmp_path / "in", kind, f"{number}.png", pressed(centre, radius))
    ended = visuohaptic(
        "images", tmp_path / "in", "--out", tmp_path / "f.parquet", "--splits", 3, "--json"
    )
    values = json.loads(ended.out)
    assert [values[name] for name in ("images", "classes", "rows", "columns")] == [20, 2, 20, 37]
    assert values["accuracy"] == 1
    assert (tmp_path / "f.parquet").is_file()


def test_wrong_levels_and_folders_are_refused(visuohaptic, tmp_path):
    assert visuohaptic("images", tmp_path, "--levels", "x").code == 2
    assert visuohaptic("images", tmp_path).code == 1
