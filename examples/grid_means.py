"""Example of a descriptor: the means of the 4 x 4 parts of an imprint."""

import visuohaptic as vh


def describe(imprints, parameters):
    """Compute the mean of each part, row by row: imprints (n, r, r) to (n, 16), for r of at least 4."""
    import numpy as np

    return np.stack(
        [
            part.mean(axis=(1, 2), dtype=float)
            for rows in np.array_split(imprints, 4, axis=1)
            for part in np.array_split(rows, 4, axis=2)
        ],
        axis=1,
    )


vh.register(vh.Descriptor("grid_means", "means of 16 parts", describe))

if __name__ == "__main__":
    import numpy as np
    import trimesh

    chosen = {"features.descriptor": "grid_means"}
    [exploration] = vh.touch(trimesh.creation.box((2, 1, 1)), viewpoints=1, parameters=chosen)
    features = exploration.features
    columns = [name for name in features.column_names if name.startswith("contourlet_")]
    print(len(columns), *np.mean([features[name] for name in columns], axis=0).round(3))
