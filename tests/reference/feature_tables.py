"""Small generated tables of touch features, and what the reference reads of them."""

import numpy as np

BANDS = [f"contourlet_{number:02d}" for number in range(1, 17)]
PLACE, NORMAL = ["x", "y", "z"], ["normal_x", "normal_y", "normal_z"]
IMPRINT = [
    f"imprint_{name}"
    for name in (
        "mean", "deviation", "skewness", "empty", "contact", "bending", "saddle", "upright_bending", "tilt_columns",
        "tilt_rows", "roughness", "step_columns", "step_rows",
    )
]  # fmt: skip
STATES = ["full", "shrunk", "at_minimum", "blocked", "partial"]


def feature_columns(objects, viewpoints=4, separation=1.0, seed=0, lengths=(5,), constant=()):
    """Return columns of the table of features: `objects` are the numbers of objects of each class.

    `lengths` are the touches of the sequences, taken in turn; `constant` names columns that are 0.25 everywhere.
    """
    generator = np.random.default_rng(seed)
    names = [*BANDS, *PLACE, *NORMAL, *IMPRINT]
    rows, turn = [], 0
    for place, count in enumerate(objects):
        of_class = separation * generator.normal(size=len(names))
        for number in range(count):
            of_object = of_class + 0.5 * generator.normal(size=len(names))
            for viewpoint in range(viewpoints):
                for touch in range(lengths[turn % len(lengths)]):
                    values = dict(
                        zip(names, of_object + generator.normal(size=len(names)), strict=True)
                    )
                    values |= {name: abs(values[name]) / 10 for name in BANDS}
                    normal = np.array([values[name] for name in NORMAL])
                    values |= dict(zip(NORMAL, normal / np.linalg.norm(normal), strict=True))
                    values |= {name: np.tanh(values[name]) / 2 for name in PLACE}
                    values |= {
                        name: (1 + np.tanh(values[name])) / 2
                        for name in ("imprint_empty", "imprint_contact")
                    }
                    values |= dict.fromkeys(constant, 0.25)
                    size = generator.choice([0.02, 0.1, 0.3])
                    rows.append({
                        "class": f"class{place}", "object": f"object{number}", "viewpoint": viewpoint, "touch": touch,
                        "strategy": "fixation", "sensor_size": size, "contact_state": generator.choice(STATES), **values,
                    })  # fmt: skip
                turn += 1
    order = generator.permutation(len(rows))
    return {name: np.array([rows[index][name] for index in order]) for name in rows[0]}


def sequences_of(columns, touches=5):
    """Return the touches of each (class, object, viewpoint), in order, as dicts; shorter sequences are left out."""
    sequences: dict = {}
    for index in range(len(columns["touch"])):
        key = tuple(columns[name][index] for name in ("class", "object", "viewpoint"))
        sequences.setdefault(key, []).append(
            {name: column[index] for name, column in columns.items()}
        )
    chosen = {}
    for key in sorted(sequences):
        ordered = sorted(sequences[key], key=lambda row: row["touch"])
        if len(ordered) >= touches:
            chosen[key] = ordered[:touches]
    return chosen


def numbers(sequence, names):
    """Return columns of a sequence as an array (t, k)."""
    return np.array([[float(row[name]) for name in names] for row in sequence])
