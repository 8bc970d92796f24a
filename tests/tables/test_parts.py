from visuohaptic.tables.parts import prune_parts


def test_pruning_deletes_parts_that_are_no_longer_named_and_nothing_else(tmp_path):
    folder = tmp_path / "fixations"
    kept, stale = folder / "cup" / "a.parquet", folder / "mug" / "b.parquet"
    notes, outside = folder / "notes.txt", tmp_path / "touches.parquet"
    for file in (kept, stale, notes, outside):
        file.parent.mkdir(parents=True, exist_ok=True)
        file.touch()
    assert prune_parts(folder, [kept]) == [stale]
    assert not stale.parent.exists()
    assert all(file.exists() for file in (kept, notes, outside))
