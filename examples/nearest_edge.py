"""Example of a policy: touch near the emptiest imprint so far. The script compares all strategies."""

import visuohaptic as vh

APART = 0.2  # object radii between two touches


def next_location(view, touches):
    """Return the visible location nearest to the emptiest imprint, and more than `APART` away from all touches."""
    import numpy as np

    points = view.places.points
    if touches:
        empty = [0 if touch.imprint is None else (touch.imprint == 0).mean() for touch in touches]
        steps = points[:, None] - np.array([touch.point for touch in touches])
        distances = np.linalg.norm(steps, axis=2)
        apart = (distances > APART).all(axis=1)
        order = np.argsort(distances[apart, np.argmax(empty)])
        points = points[apart][order]
    return points[0] if len(points) else None


vh.register(vh.Policy("nearest_edge", "beside the emptiest imprint", next_location))

if __name__ == "__main__":
    import sys
    from pathlib import Path

    import pyarrow as pa
    import pyarrow.compute as pc
    from matplotlib.figure import Figure
    from sklearn.model_selection import cross_val_score
    from sklearn.neighbors import KNeighborsClassifier
    from sklearn.pipeline import make_pipeline
    from sklearn.preprocessing import StandardScaler

    from visuohaptic.fixations.probing import STRATEGIES
    from visuohaptic.geometry.raycasting import RayCaster
    from visuohaptic.geometry.subject import Subject
    from visuohaptic.parameters import as_parameters
    from visuohaptic.pipeline import run
    from visuohaptic.recognition import LeaveOneObjectPerClassOut, touch_descriptors
    from visuohaptic.recognition.parameters import RecognitionParameters

    parameters = as_parameters({"probing.strategies": STRATEGIES.names, "viewpoints.count": 4})
    objects = [vh.load(path) for path in sorted(Path("meshes/paper").glob("*/*.ply.gz"))]
    subjects = [
        Subject(thing.key, lambda thing=thing: RayCaster(thing.surface), range(4))
        for thing in objects
    ]
    features = pa.concat_tables(run(subject, parameters)["features"] for subject in subjects)
    model, counts = make_pipeline(StandardScaler(), KNeighborsClassifier(1)), range(1, 6)
    figure = Figure(figsize=(7, 4), layout="constrained")
    axes = figure.subplots()
    axes.set(xlabel="touches of one view", ylabel="correctly classified, %", xticks=counts)
    for name in STRATEGIES.names:
        touched = features.filter(pc.equal(features["strategy"], name))
        accuracies = []
        for count in counts:
            chosen = RecognitionParameters(touches=count)
            rows, classes, groups = touch_descriptors(touched, chosen)
            splits = LeaveOneObjectPerClassOut()
            scores = cross_val_score(model, rows, classes, groups=groups, cv=splits)
            accuracies.append(100 * scores.mean())
        print(name, *(f"{value:.1f}" for value in accuracies))
        marked = {"color": "black", "lw": 3} if name == "nearest_edge" else {"lw": 1}
        axes.plot(counts, accuracies, "o-", label=name, ms=3, **marked)
    axes.legend(loc="center left", bbox_to_anchor=(1, 0.5), frameon=False)
    if sys.argv[1:]:
        figure.savefig(sys.argv[1], dpi=150)
