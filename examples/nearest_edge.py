"""A policy of one's own, which touches beside the emptiest imprint so far, against all strategies."""

import visuohaptic as vh

APART = 0.2  # object radii between two touches


def next_location(view, touches):
    """Return the seen place that is nearest to the emptiest imprint and apart from all touches."""
    import numpy as np

    places = view.places.points
    if touches:
        empty = [0 if one.imprint is None else (one.imprint == 0).mean() for one in touches]
        steps = places[:, None] - np.array([one.point for one in touches])
        distances = np.linalg.norm(steps, axis=2)
        apart = (distances > APART).all(axis=1)
        order = np.argsort(distances[apart, np.argmax(empty)])
        places = places[apart][order]
    return places[0] if len(places) else None


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

    asked = as_parameters({"probing.strategies": STRATEGIES.names, "viewpoints.count": 4})
    objects = [vh.load(path) for path in sorted(Path("meshes/paper").glob("*/*.ply.gz"))]
    subjects = [
        Subject(one.key, lambda one=one: RayCaster(one.surface), range(4)) for one in objects
    ]
    features = pa.concat_tables(run(subject, asked)["features"] for subject in subjects)
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
