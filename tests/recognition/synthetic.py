"""Synthetic tables of touch features: classes apart by `separation`, objects apart within each."""

import numpy as np

from visuohaptic.recognition.sequences import TouchSequences
from visuohaptic.tables.phases import (
    CONTOURLET_FEATURES,
    FEATURES,
    IMPRINT_FEATURES,
    KINESTHETIC_FEATURES,
)
from visuohaptic.tables.schema import build_table

PAPER_FEATURES = (*CONTOURLET_FEATURES, *KINESTHETIC_FEATURES)


def features_table(
    strategy="fixation",
    objects=(3, 3, 3, 3),
    viewpoints=4,
    touches=5,
    separation=1.0,
    seed=0,
):
    """Return `tables.FEATURES` of len(objects) classes with so many objects each."""
    generator = np.random.default_rng(seed)
    centres = np.random.default_rng(100).normal(size=(len(objects), 22)) * separation
    owners = [(place, number) for place, count in enumerate(objects) for number in range(count)]
    offsets = [0.5 * np.random.default_rng((5, *owner)).normal(size=22) for owner in owners]
    middles = centres[[place for place, _ in owners]] + offsets
    rows = viewpoints * touches
    values = np.repeat(middles, rows, axis=0) + generator.normal(size=(rows * len(owners), 22))
    columns = {
        "class": np.repeat([f"class{place}" for place, _ in owners], rows),
        "object": np.repeat([f"object{number}" for _, number in owners], rows),
        "viewpoint": np.tile(np.repeat(np.arange(viewpoints), touches), len(owners)),
        "strategy": strategy,
        "touch": np.tile(np.arange(touches), viewpoints * len(owners)),
        "sensor_size": 0.1,
        "contact_state": "full",
    }
    columns |= dict(zip(CONTOURLET_FEATURES, np.abs(values[:, :16]).T, strict=True))
    columns |= dict(zip(KINESTHETIC_FEATURES, np.tanh(values[:, 16:]).T, strict=True))
    return build_table(FEATURES, columns | dict.fromkeys(IMPRINT_FEATURES, 0.5))


def sequences_of(touches, names, labels, owners, classes):
    """Return sequences (s, t, k) of numbered objects; one without sequences is of the first class."""
    of_object = dict(zip(owners.tolist(), labels.tolist(), strict=True))
    return TouchSequences(
        features=touches,
        feature_names=tuple(names),
        objects=tuple(
            (f"class{of_object.get(place, 0)}", f"object{place}")
            for place in range(owners.max() + 1)
        ),
        classes=tuple(f"class{place}" for place in range(classes)),
        object_index=owners,
        viewpoint=np.zeros(len(owners), dtype=np.int64),
    )


def with_column(table, name, values):
    """Return the table with one column's values replaced."""
    place = table.schema.get_field_index(name)
    return table.set_column(place, table.schema.field(name), [values])


def clusters(objects=(3, 3, 3), sequences=8, columns=20, separation=2.0, seed=0):
    generator = np.random.default_rng(seed)
    labels = np.repeat(np.repeat(np.arange(len(objects)), objects), sequences)
    owners = np.repeat(np.arange(sum(objects)), sequences)
    centres = separation * generator.normal(size=(len(objects), columns))
    return centres[labels] + generator.normal(size=(len(labels), columns)), labels, owners
