"""What was left out is named with its reason."""

from types import SimpleNamespace

import pyarrow as pa

from visuohaptic.parameters import ExperimentParameters
from visuohaptic.report.cautions import (
    _equal_surfaces,
    _notes_on_files,
    _objects_left_out,
    _short_sequences,
    _unfitted_classifiers,
)
from visuohaptic.report.sections import count_missing, count_passed_over

BEST = ExperimentParameters().recognition.order_free.classifiers


def test_of_thousands_of_objects_some_are_named_and_the_others_counted():
    keys = tuple(f"cup/{number:04d}" for number in range(3000))
    sampled = {"recognition": {"protocol": {"protocol": "leave_one_object_a_class_out"}}}
    run = SimpleNamespace(
        parameters=ExperimentParameters.from_mapping(sampled),
        all_objects=keys,
        objects=keys[1000:],
        tested_objects=keys[:1],
        set_aside=dict.fromkeys(keys[:1000], "no faces."),
    )
    *reasons, others, untested = _objects_left_out(run)
    assert reasons == [f"cup/{number:04d} was left out: no faces." for number in range(20)]
    assert others.startswith("980 more objects left out: cup/0020, cup/0021")
    assert others.endswith("cup/0029 and 970 more.")
    assert "2,000 objects touched, but never tested by recognition: cup/1000, cup/1001" in untested
    assert "cup/1009 and 1,990 more. Protocol auto" in untested


def test_notes_on_files_are_said_once_per_object_and_beyond_some_counted():
    run = SimpleNamespace(
        notes={f"cup/{k:02d}": ["a.mtl is missing.", "z is up."] for k in range(22)}
    )
    *said, others = _notes_on_files(run)
    assert said[:2] == ["cup/00: a.mtl is missing.", "cup/00: z is up."]
    assert len(said) == 40
    assert others == "2 more objects with notes on the model's file: cup/20 and cup/21."


def test_objects_with_the_same_surface_are_named_and_others_of_the_same_size_are_not(tmp_path):
    meshes = {}
    for key, content in {
        "cup/mug": "abc",
        "jar/pot": "abc",
        "cup/jug": "abd",
        "cup/tea": "a",
    }.items():
        meshes[key] = tmp_path / key.replace("/", "_")
        meshes[key].write_text(content)
    (sentence,) = _equal_surfaces(SimpleNamespace(meshes=meshes))
    assert sentence.startswith(
        "cup/mug and jar/pot have the same surface, so accuracies are too high:"
    )


def test_a_classifier_without_figures_is_named():
    run = SimpleNamespace(
        parameters=ExperimentParameters(),
        metrics={"results": {"order_free": {"fixation": {name: {} for name in BEST[1:]}}}},
    )
    (sentence,) = _unfitted_classifiers(run)
    assert sentence.startswith("1 classifier of pipeline order_free left out")
    assert sentence.endswith(f": {BEST[0].replace('_', ' ')}.")


def run_of(ranks, distinct=5):
    """Return a run of one object with touches of these ranks, by viewpoint and strategy."""
    mug = {"class": "cup", "object": "mug"}
    rows = [
        {**mug, "viewpoint": viewpoint, "strategy": name, "rank": rank}
        for (viewpoint, name), found in ranks.items()
        for rank in found
    ]
    seen = dict.fromkeys(viewpoint for viewpoint, _ in ranks)
    views = [{**mug, "viewpoint": viewpoint, "distinct_fixations": distinct} for viewpoint in seen]
    return SimpleNamespace(
        parameters=ExperimentParameters(),
        touches=pa.Table.from_pylist(rows),
        views=pa.Table.from_pylist(views),
    )


def test_places_passed_over_and_missing_touches_are_counted_and_named():
    run = run_of(
        {
            (0, "fixation"): [0, 1, 3, 4, 6],
            (0, "random"): [2, 3, 4, 5, 6],
            (1, "fixation"): [1, 3, 1, 3, 1],  # it began again, and passed over no more
            (1, "random"): [0, 9],
            (2, "fixation"): [0, 1, 2, 3, 4],
            (2, "random"): [],
        }
    )
    assert count_passed_over(run.touches) == {"fixation": 2 + 2, "random": 2 + 8}
    assert count_missing(run) == {"fixation": 0, "random": 3 + 5}
    (sentence,) = _short_sequences(run)
    assert sentence.startswith("2 sequences with fewer than 5 places in reach")
    assert sentence.endswith("cup/mug (view 1, random) and cup/mug (view 2, random).")


def test_views_that_are_named_for_their_few_fixations_are_not_named_again():
    run = run_of({(0, "fixation"): [0, 1], (0, "random"): [0, 1, 2, 3, 4]}, distinct=2)
    assert _short_sequences(run) == []
