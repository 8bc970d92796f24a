"""Lines of the library that are broken one at a time: the suite notices each."""

import pytest
from numerics import mutations


@pytest.mark.hard
def test_every_mutation_is_caught(recorder, tmp_path):
    rows = mutations.run(tmp_path)
    for row in rows:
        recorder.tell("mutations", row)
    assert len(rows) >= 10
    assert all(row["caught_by"] for row in rows), [
        row["change"] for row in rows if not row["caught_by"]
    ]


def test_every_line_to_be_broken_is_still_there():
    lost = [mutation.name for mutation in mutations.MUTATIONS if mutations.count(mutation) != 1]
    assert not lost
