"""Models that are saved, read, and refused."""

import dataclasses
import functools
import json
import pickle
import re
import tracemalloc
import zipfile

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
import pytest
import skops.io
from recognition.synthetic import clusters, features_table, with_column
from sklearn.naive_bayes import GaussianNB
from sklearn.pipeline import Pipeline

from visuohaptic import recognition
from visuohaptic.base.errors import RecognitionError
from visuohaptic.evaluation.summary import select
from visuohaptic.recognition import certainty, pipelines, stored_models
from visuohaptic.recognition.classifiers import CLASSIFIERS
from visuohaptic.recognition.parameters import RecognitionParameters
from visuohaptic.recognition.splits import held_out_folds
from visuohaptic.recognition.stored_models import FORMAT, FORMER_FORMAT

TABLE = features_table(objects=(3, 3), separation=3.0)
OTHER = features_table(objects=(4, 4), separation=3.0, seed=7)
LARGER = features_table(objects=(8, 8), separation=3.0)
PARAMETERS = RecognitionParameters()
SAFE = {
    "k_nearest_neighbours", "support_vector_machine", "quadratic_discriminant", "naive_bayes",
    "linear_discriminant", "logistic_regression",
}  # fmt: skip


def fit(table, classifier, pipeline="order_free"):
    return recognition.fit_model(table, pipeline, classifier, PARAMETERS, 1)


def rows_of(table, category, name):
    return select(table, **{"class": category, "object": name})


@pytest.mark.parametrize("classifier", CLASSIFIERS.names)
def test_a_model_is_saved_and_answers_the_same_bit_for_bit_or_is_refused(classifier, tmp_path):
    model = fit(LARGER, classifier)
    path = tmp_path / "models" / "a.skops"
    # Of a plug-in's classifier nothing is known: it may be saved, too.
    refused = ""
    try:
        recognition.save_model(model, path)
    except RecognitionError as error:
        refused = str(error)
    if refused:
        assert classifier not in SAFE
        assert "can't be saved so that" in refused
        assert list(tmp_path.iterdir()) == []
        return
    assert classifier != "decision_tree"
    loaded = recognition.load_model(path)
    unseen = rows_of(OTHER, "class1", "object3")
    assert loaded.answer(unseen) == model.answer(unseen)
    for name in ("strategies", "objects", "feature_names", "versions", "parameters"):
        assert getattr(loaded, name) == getattr(model, name)
    assert set(loaded.versions) >= {"visuohaptic", "numpy", "scikit-learn", "python"}


class Mischief:
    def __reduce__(self):
        return (print, ("this must not run",))


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        (
            skops.io.dumps({"format": Mischief()}),
            "it needs .*Mischief, and such code is not run; train the model again",
        ),
        (pickle.dumps(Mischief()), "the file is damaged or of another kind; train the model again"),
        (skops.io.dumps({"format": "something else"}), "is a 'something else'"),
        (skops.io.dumps({"format": FORMAT}), "'description' is missing; train"),
        (None, "there is no such file; train the model again"),
    ],
)
def test_foreign_broken_and_missing_files_are_refused_and_run_nothing(
    content, reason, tmp_path, capsys
):
    path = tmp_path / "m.skops"
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(RecognitionError, match=reason) as refusal:
        recognition.load_model(path)
    assert not re.search("(Error|Exception|BadZipFile)", str(refusal.value))
    assert capsys.readouterr().out == ""


def test_a_small_file_that_unpacks_to_a_large_one_is_refused_before_it_is_unpacked(
    tmp_path, monkeypatch
):
    path = tmp_path / "m.skops"
    state = {"format": FORMAT, "zeros": np.zeros(10**6)}
    path.write_bytes(skops.io.dumps(state, compression=zipfile.ZIP_DEFLATED))
    assert path.stat().st_size < 10**5
    monkeypatch.setattr(stored_models, "LARGEST_BYTES", 10**6)
    monkeypatch.setattr(skops.io, "loads", lambda *_, **__: pytest.fail("unpacked"))
    with pytest.raises(RecognitionError, match="unpacks to 8 MB"):
        recognition.load_model(path)


def test_parts_that_share_a_member_count_once_each(tmp_path, monkeypatch):
    zeros = np.zeros(10**5)
    path = tmp_path / "m.skops"
    path.write_bytes(skops.io.dumps({"format": FORMAT, "parts": [zeros] * 20}))
    with zipfile.ZipFile(path) as archive:
        assert sum(member.file_size for member in archive.infolist()) < 10**6
    monkeypatch.setattr(stored_models, "LARGEST_BYTES", 10**6)
    monkeypatch.setattr(skops.io, "loads", lambda *_, **__: pytest.fail("read"))
    with pytest.raises(RecognitionError, match="unpacks to 16 MB"):
        recognition.load_model(path)


def test_a_member_that_is_larger_than_the_directory_states_takes_little_memory(tmp_path):
    size = 40_000_128
    state = {"format": FORMAT, "zeros": np.zeros(5_000_000)}
    content = skops.io.dumps(state, compression=zipfile.ZIP_DEFLATED)
    lying = content.replace(size.to_bytes(4, "little"), (1000).to_bytes(4, "little"))
    assert lying != content
    (tmp_path / "m.skops").write_bytes(lying)
    tracemalloc.start()
    try:
        with pytest.raises(RecognitionError, match="damaged"):
            recognition.load_model(tmp_path / "m.skops")
        assert tracemalloc.get_traced_memory()[1] < size / 4
    finally:
        tracemalloc.stop()


@pytest.mark.parametrize(
    ("name", "says"), [("MOST_MEMBERS", "more than 1 members"), ("LARGEST_SCHEMA_BYTES", "at most")]
)
def test_a_model_of_too_many_or_too_large_parts_is_refused(tmp_path, monkeypatch, name, says):
    path = tmp_path / "m.skops"
    path.write_bytes(skops.io.dumps({"format": FORMAT, "zeros": np.zeros(3)}))
    monkeypatch.setattr(stored_models, name, 1)
    with pytest.raises(RecognitionError, match=says):
        recognition.load_model(path)


def test_single_class_can_not_be_learnt():
    with pytest.raises(RecognitionError, match="one class"):
        fit(features_table(objects=(3,)), "naive_bayes")


def test_temperature_and_certainty_are_fitted_on_folds_of_whole_objects(monkeypatch):
    sequences_of_object = []

    def catching(labels, owners, *further):
        sequences_of_object.append(np.unique(owners, return_counts=True)[1])
        return held_out_folds(labels, owners, *further)

    for module in (pipelines, certainty):
        monkeypatch.setattr(module, "held_out_folds", catching)
    table = features_table(objects=(3, 4), viewpoints=4)
    model = fit(table, "naive_bayes")
    # The final model and its certainty see all objects, the models of certainty's folds fewer.
    assert [len(counts) for counts in sequences_of_object[:2]] == [7, 7]
    assert {*np.concatenate(sequences_of_object)} == {4}
    assert len(model.certainties["fixation"].labels) == 7


def test_contact_states_and_sensor_sizes_are_used_where_a_table_has_them():
    generator = np.random.default_rng(0)
    states = generator.choice(["full", "shrunk", "blocked"], size=TABLE.num_rows)
    table = with_column(TABLE, "contact_state", states)
    table = with_column(table, "sensor_size", generator.uniform(0.02, 0.3, TABLE.num_rows))
    model = fit(table, "naive_bayes")
    assert {"sensor_size", "contact_full", "contact_blocked"} <= set(model.feature_names)
    assert recognition.run_pipeline(table, PARAMETERS, 1, "paper")[0].num_rows == 9 * 5
    model.recognise(rows_of(table, "class0", "object0"))


@pytest.mark.parametrize("touches", [1, 2, 5, 7])
def test_any_number_of_touches_of_an_object_that_was_not_learnt_gets_an_answer(touches):
    longer = features_table(objects=(4, 4), touches=touches, separation=3.0, seed=7)
    model = fit(TABLE, "linear_discriminant")
    assert ("class1", "object3") not in model.objects
    unseen = rows_of(longer, "class1", "object3")
    for rows in (unseen, select(unseen, viewpoint=0)):
        found = model.answer(rows)
        chances = list(found.probabilities.values())
        assert next(iter(found.probabilities)) == "class1"
        assert sum(chances) == pytest.approx(1)
        assert chances == sorted(chances, reverse=True)
        assert found.coverage == 0.9
        assert set(found.candidates) <= {"class0", "class1"}
        assert found.candidates[0] == "class1"
    with pytest.raises(RecognitionError, match="There is no touch"):
        model.recognise(TABLE.slice(0, 0))


def with_scores(model, **scores):
    """Return the model with other scores of its training objects."""
    changed = dataclasses.replace(model.certainties["fixation"], **scores)
    return dataclasses.replace(model, certainties={"fixation": changed})


def test_the_named_class_is_in_its_set_even_if_it_conforms_worse_than_all_training_objects():
    model = fit(features_table(objects=(6, 6), separation=3.0, seed=7), "linear_discriminant")
    unseen = rows_of(OTHER, "class1", "object3")
    shape = model.certainties["fixation"].nonconformity.shape
    # No object was classified as badly as this one: of 12, each class can be left out.
    answer = with_scores(model, nonconformity=np.full(shape, -1.0)).answer(unseen)
    assert answer.candidates == ("class1",)
    both = with_scores(model, nonconformity=np.ones(shape)).answer(unseen)
    assert both.candidates == ("class1", "class0")


@pytest.mark.parametrize(("objects", "unknown"), [((14, 14), None), ((15, 14), True)])
def test_a_model_of_too_few_objects_does_not_say_whether_an_object_is_unknown(objects, unknown):
    table = features_table(objects=objects, viewpoints=2, separation=3.0, seed=7)
    model = fit(table, "naive_bayes")
    assert model.can_call_unknown("fixation") is (unknown is not None)
    assert model.can_call_unknown("random") is False
    nearest = np.zeros_like(model.certainties["fixation"].novelty)
    answer = with_scores(model, novelty=nearest).answer(rows_of(OTHER, "class1", "object3"))
    assert answer.unknown is unknown
    assert answer.compared == sum(objects)
    assert answer.novelty_rank == pytest.approx(sum(objects) / (sum(objects) + 1))


def test_a_saved_model_lacks_the_covariances_that_no_prediction_reads(tmp_path):
    model = fit(LARGER, "linear_discriminant")
    recognition.save_model(model, tmp_path / "a.skops")
    loaded = recognition.load_model(tmp_path / "a.skops")
    for fitted, has_covariances in ((model, True), (loaded, False)):
        discriminants = [one.estimator for one in fitted.estimator[-1].calibrated_classifiers_]
        assert {hasattr(one, "covariance_") for one in discriminants} == {has_covariances}


def test_a_model_of_the_papers_pipeline_answers_and_is_not_saved(tmp_path):
    model = fit(TABLE, "naive_bayes", "paper")
    assert next(iter(model.recognise(rows_of(OTHER, "class1", "object3")))) == "class1"
    with pytest.raises(RecognitionError, match="pipeline paper can't be saved"):
        recognition.save_model(model, tmp_path / "m.skops")


@pytest.mark.parametrize(
    ("part", "change", "reason"),
    [
        (("waves", "phases"), lambda rows: rows[:-1], "broadcast"),
        (
            ("certainties", "fixation", "novelty"),
            lambda rows: rows * np.nan,
            "no array of finite numbers",
        ),
        (
            ("certainties",),
            lambda found: {"random": found["fixation"]},
            "strategies and the certainties do not fit each other",
        ),
        (
            ("description",),
            lambda text: text.replace('["fixation"]', "[]", 1),
            "strategies and the certainties do not fit each other",
        ),
        (("estimator",), lambda pipeline: pipeline[-1], "is no pipeline"),
        (
            ("description",),
            lambda text: text.replace('"class0"', '"class0", "one more"', 1),
            "no probabilities of 3 classes",
        ),
    ],
)
def test_a_model_whose_parts_do_not_belong_together_is_refused_in_a_sentence(
    tmp_path, part, change, reason
):
    state, path = saved_state(tmp_path)
    *above, last = part
    inside = functools.reduce(dict.get, above, state)
    inside[last] = change(inside[last])
    path.write_bytes(skops.io.dumps(state))
    with pytest.raises(RecognitionError, match=f"is no complete .*({reason})"):
        recognition.load_model(path)


@pytest.mark.parametrize("has_certainty", [True, False])
def test_a_file_of_the_former_format_with_one_strategy_is_read(tmp_path, has_certainty):
    state, path = saved_state(tmp_path)
    expected = recognition.load_model(path)
    description = json.loads(state["description"])
    (description["strategy"],) = description.pop("strategies")
    state["certainty"] = state.pop("certainties")["fixation"] if has_certainty else None
    state |= {"format": FORMER_FORMAT, "description": json.dumps(description)}
    path.write_bytes(skops.io.dumps(state))
    found = recognition.load_model(path)
    assert found.strategies == ("fixation",)
    unseen = rows_of(OTHER, "class1", "object3")
    assert found.recognise(unseen) == expected.recognise(unseen)
    if has_certainty:
        assert found.answer(unseen) == expected.answer(unseen)
    else:
        assert found.answer(unseen).candidates is None


BY_CHANCE = features_table("random", objects=(8, 8), separation=3.0, seed=3)


@pytest.fixture(scope="module")
def of_two():
    """A model of twice as many objects touched by fixation as by random."""
    fewer = BY_CHANCE.filter(pc.less(BY_CHANCE["object"], "object4"))
    return fit(pa.concat_tables([LARGER, fewer]), "linear_discriminant")


def test_a_model_learns_from_several_strategies_and_compares_touches_with_those_of_their_strategy(
    of_two,
):
    assert of_two.strategies == ("fixation", "random")
    assert len(of_two.objects) == 16
    counts = {name: len(found.labels) for name, found in of_two.certainties.items()}
    assert counts == {"fixation": 16, "random": 8}
    for table in (OTHER, BY_CHANCE):
        unseen = rows_of(table, "class1", "object3")
        assert next(iter(of_two.recognise(unseen))) == "class1"
    alone = dataclasses.replace(
        of_two,
        strategies=("random",),
        certainties={"random": of_two.certainties["random"]},
    )
    unseen = rows_of(BY_CHANCE, "class1", "object3")
    assert of_two.answer(unseen) == alone.answer(unseen)


def test_fewer_folds_compute_as_many_scores():
    (few,) = recognition.fit_model(
        LARGER, "order_free", "naive_bayes", PARAMETERS, 1, folds=2
    ).certainties.values()
    (own,) = fit(LARGER, "naive_bayes").certainties.values()
    for name in ("trained", "labels", "views", "nonconformity", "novelty"):
        assert getattr(few, name).shape == getattr(own, name).shape
    assert not np.array_equal(few.novelty, own.novelty)
    np.testing.assert_array_equal(few.reference.centres, own.reference.centres)


def test_an_object_is_compared_by_models_that_learnt_it_by_no_strategy_with_touches_of_its_own():
    rows, labels, owners = clusters(objects=(6, 6), separation=0.3, sequences=4)
    learnt = []

    def fit_fold(rows, labels, owners):
        learnt.append(set(owners))
        return Pipeline([("preparation", "passthrough"), ("classifier", GaussianNB())]).fit(
            rows, labels
        )

    both = (np.concatenate([rows, rows + 5]), np.tile(labels, 2), np.tile(owners, 2))
    final = fit_fold(*both)
    same_strategy = np.arange(2 * len(rows)) < len(rows)
    folds = held_out_folds(both[1], both[2], certainty.FOLDS)
    found = certainty.fit_certainty(fit_fold, final, *both, same_strategy=same_strategy)
    assert learnt[1:] == [set(owners) - set(both[2][held_out]) for _, held_out in folds]
    alone = certainty.fit_certainty(fit_fold, final, rows, labels, owners)
    np.testing.assert_array_equal(found.novelty, alone.novelty)
    np.testing.assert_array_equal(found.reference.centres, alone.reference.centres)
    assert (found.nonconformity != alone.nonconformity).any()


def test_touches_by_another_strategy_get_probabilities_without_a_prediction_set():
    model = fit(TABLE, "linear_discriminant")
    unseen = rows_of(OTHER, "class1", "object3")
    known = model.answer(unseen)
    found = model.answer(with_column(unseen, "strategy", ["random"] * unseen.num_rows))
    assert found == recognition.model.ModelAnswer(known.probabilities)
    assert known.candidates is not None


def test_draws_of_a_random_strategy_touch_as_the_strategy_does():
    model = fit(BY_CHANCE, "linear_discriminant")
    assert model.matching_strategy("random#2") == model.matching_strategy("random") == "random"
    assert model.matching_strategy("random_anywhere") is None
    again = features_table("random#1", objects=(8, 8), separation=3.0, seed=3)
    assert fit(again, "naive_bayes").matching_strategy("random") == "random#1"


def test_strategies_with_other_numbers_of_touches_are_not_learnt_together():
    all_touches = RecognitionParameters(touches=None)
    longer = features_table("random", touches=7)
    with pytest.raises(RecognitionError, match="different features or numbers of touches per"):
        recognition.fit_model(
            pa.concat_tables([features_table(), longer]),
            "order_free",
            "naive_bayes",
            all_touches,
            1,
        )
    with pytest.raises(RecognitionError, match="The features hold no touches"):
        fit(TABLE.slice(0, 0), "naive_bayes")


def saved_state(folder, classifier="support_vector_machine"):
    """Return what a model file holds, and its path."""
    path = folder / "m.skops"
    recognition.save_model(fit(TABLE, classifier), path)
    return skops.io.loads(path.read_bytes(), trusted=list(stored_models.TRUSTED)), path


@pytest.mark.parametrize(
    ("name", "change"),
    [
        ("support_vectors_", lambda rows: rows[:-1]),
        ("_n_support", lambda counts: counts + 1),
        ("_n_support", lambda counts: np.array([-1, counts.sum() + 1], counts.dtype)),
        ("_dual_coef_", lambda rows: rows[:, :-1]),
        ("intercept_", lambda values: values[:0]),
    ],
)
def test_arrays_that_libsvm_would_read_beyond_their_ends_are_refused_before_it_reads(
    tmp_path, name, change
):
    state, path = saved_state(tmp_path)
    machine = state["estimator"][-1].calibrated_classifiers_[0].estimator
    setattr(machine, name, change(getattr(machine, name)))
    path.write_bytes(skops.io.dumps(state))
    with pytest.raises(RecognitionError, match="do not fit each other"):
        recognition.load_model(path)


def test_tables_of_pandas_and_of_other_types_of_text_get_the_same_answer():
    model = fit(TABLE, "linear_discriminant")
    rows = rows_of(TABLE, "class0", "object0")
    expected = model.answer(rows)
    fields = [
        field.with_type(pa.large_string()) if field.type == pa.string() else field
        for field in rows.schema
    ]
    for same in (
        rows.cast(pa.schema(fields)),
        rows.to_pandas(),
        rows.to_pandas().astype({"class": "category"}),
    ):
        assert model.answer(same) == expected
    with pytest.raises(RecognitionError, match="is given as list"):
        model.answer([1])
