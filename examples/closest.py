"""Example of a probing strategy: touch the locations that are closest to the eye."""

import visuohaptic as vh


def choose_closest(viewpoint, attention, generator):
    """Draw locations that the viewpoint sees, and return the closest first."""
    import numpy as np

    from visuohaptic.fixations import draw_visible

    seen = draw_visible(viewpoint.caster, viewpoint.camera, 256, generator)
    distances = np.linalg.norm(seen.points - viewpoint.camera.eye, axis=1)
    return seen.take(np.argsort(distances, kind="stable")[: attention.fixations])


vh.register(vh.Strategy("closest", "the closest places", choose_closest, needs_view=False))

if __name__ == "__main__":
    import numpy as np
    import trimesh

    exploration = vh.load(trimesh.creation.icosphere(3)).touch(viewpoints=1, strategy="closest")
    eye = exploration.views.select(["eye_x", "eye_y", "eye_z"]).to_pylist()[0].values()
    rows = exploration.touches.select(["x", "y", "z"]).to_pylist()
    points = np.array([list(row.values()) for row in rows])
    print(*np.linalg.norm(points - list(eye), axis=1).round(3))
