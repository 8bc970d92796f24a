"""A probing strategy of one's own: touch the places that are closest to the eye."""

import visuohaptic as vh


def choose_closest(one, attention, generator):
    """Draw places that the viewpoint sees, and give the closest first."""
    import numpy as np

    from visuohaptic.fixations.strategies.visible import draw_visible

    seen = draw_visible(one.caster, one.camera, 256, generator)
    distances = np.linalg.norm(seen.points - one.camera.eye, axis=1)
    return seen.take(np.argsort(distances, kind="stable")[: attention.fixations])


vh.register(vh.Strategy("closest", "the closest places", choose_closest, looks=False))

if __name__ == "__main__":
    import numpy as np
    import trimesh

    found = vh.load(trimesh.creation.icosphere(3)).touch(viewpoints=1, strategy="closest")
    eye = found.views.select(["eye_x", "eye_y", "eye_z"]).to_pylist()[0].values()
    places = [list(row.values()) for row in found.touches.select(["x", "y", "z"]).to_pylist()]
    print(*np.linalg.norm(np.array(places) - list(eye), axis=1).round(3))
