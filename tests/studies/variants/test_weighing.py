"""A variant's figures are those that scikit-learn and PyWavelets alone give."""

import itertools
import json

import numpy as np
import pyarrow as pa
import pytest
import pywt
from recognition.synthetic import features_table
from sklearn.neighbors import KNeighborsClassifier
from sklearn.svm import SVC

from variants.design import STRATEGIES
from variants.one import make_variant
from variants.study import STUDY as STUDY_OF_VARIANTS
from variants.summary import make_variants
from variants.tables import VARIANTS
from visuohaptic.evaluation.published import TABLE_1
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.studies.conditions import describe_conditions, plan_study
from visuohaptic.studies.measuring import make_study_block
from visuohaptic.studies.study import StepInputs
from visuohaptic.tables.phases import CONTOURLET_FEATURES, FEATURES, KINESTHETIC_FEATURES, owners_of
from visuohaptic.tables.schema import matrix, read_table, write_table

# Attention of the design's base, so that a variant may take the run's features.
RUN = ExperimentParameters.model_validate(
    {
        "probing": {"strategies": STRATEGIES},
        "attention": {"weights": "equal"},
    }
)
OBJECTS = (2, 2, 2)


@pytest.fixture(scope="module")
def features(tmp_path_factory):
    path = tmp_path_factory.mktemp("features") / "features.parquet"
    parts = [
        features_table(strategy, OBJECTS, separation=0.3, seed=place)
        for place, strategy in enumerate(STRATEGIES)
    ]
    write_table(FEATURES, pa.concat_tables(parts), path)
    return path


def conditions(*names):
    planned = plan_study(STUDY_OF_VARIANTS, RUN).conditions
    return describe_conditions([one for one in planned if one.condition.name in names])


DEFAULT = "r000"
# Groups of features, no scaling, zeros beyond a sequence's ends, approximations, MATLAB's settings.
FEATURE_GROUPS = "r268"
ONLINE_LATTICE = "t006"


@pytest.fixture(scope="module")
def made(features, tmp_path_factory):
    folder = tmp_path_factory.mktemp("variants")
    block, table, summary = (folder / name for name in ("block", "table", "summary"))
    chosen = conditions(DEFAULT, FEATURE_GROUPS, ONLINE_LATTICE)
    make_study_block("variants", chosen, [features], {}, block, RUN.seed)
    make_variants(StepInputs("variants", {"blocks": [block]}, [table, summary], RUN))
    return read_table(VARIANTS, table).to_pylist(), json.loads(summary.read_text())


def by_hand(features, strategy, reduce_touches, mode, approximations, classifier):
    """Return the accuracy of every split, without a line of the package but its table reader."""
    table = read_table(FEATURES, features)
    table = table.filter(pa.compute.equal(table.column("strategy"), strategy))
    rows = matrix(table, [*CONTOURLET_FEATURES, *KINESTHETIC_FEATURES]).reshape(-1, 5, 22)
    owner = np.array(["/".join(one) for one in owners_of(table)])[::5]
    label = np.array([one.partition("/")[0] for one in owner])
    accuracies = []
    for tested in itertools.product(*(np.unique(owner[label == one]) for one in np.unique(label))):
        test = np.isin(owner, tested)
        five = reduce_touches(rows[~test].reshape(-1, 22), rows.reshape(-1, 22)).reshape(-1, 5, 5)
        encoded = np.array([describe(sequence, mode, approximations) for sequence in five])
        deviation = encoded[~test].std(axis=0)
        encoded = (encoded - encoded[~test].mean(axis=0)) / np.where(deviation > 0, deviation, 1)
        predicted = classifier().fit(encoded[~test], label[~test]).predict(encoded[test])
        accuracies.append((predicted == label[test]).mean())
    return np.array(accuracies)


def describe(sequence, mode, approximations):
    """Return deviation, rms and skewness of five sequences and of three levels of each."""
    found = []
    for signal in sequence.T:
        levels, rest = [signal], signal
        for _ in range(3):
            rest, detail = pywt.dwt(rest, "db2", mode)
            levels.append(rest if approximations else detail)
        for level in levels:
            second, third = (((level - level.mean()) ** power).mean() for power in (2, 3))
            skewness = third / second**1.5 if second else 0.0
            found += [level.std(ddof=1), np.sqrt((level**2).mean()), skewness]
    return found


def units_of_a_map(touches):
    """Fit Kohonen's batch map of five units in a row, with loops."""
    centre = touches.mean(axis=0)
    _, scales, directions = np.linalg.svd(touches - centre, full_matrices=False)
    first = directions[0] * np.sign(directions[0][np.abs(directions[0]).argmax()])
    units = centre + np.outer([-1, -0.5, 0, 0.5, 1], first * scales[0] / np.sqrt(len(touches)))
    radii = np.geomspace(2.0, 0.5, 20).tolist() + [0.5] * 200
    nearest = closest(touches, units)
    for number, radius in enumerate(radii):
        away = np.arange(5)[:, None] - nearest
        pulls = np.exp(-(away**2) / (2 * radius**2))
        units = pulls @ touches / pulls.sum(axis=1, keepdims=True)
        before, nearest = nearest, closest(touches, units)
        if number >= 20 and (before == nearest).all():
            break
    return units


def closest(touches, units):
    return np.array([np.argmin(((touch - units) ** 2).sum(axis=1)) for touch in touches])


def distances_to_units(training, touches):
    mean, deviation = training.mean(axis=0), training.std(axis=0)
    units = units_of_a_map((training - mean) / deviation)
    scaled = (touches - mean) / deviation
    return np.sqrt(((scaled[:, None] - units) ** 2).sum(axis=-1))


def means_of_groups(training, touches):
    group = closest(training.T, units_of_a_map(training.T))
    means = np.zeros((len(touches), 5))
    for unit in np.unique(group):
        means[:, unit] = touches[:, group == unit].mean(axis=1)
    return means


@pytest.mark.slow
@pytest.mark.parametrize(
    ("variant", "classifier", "how"),
    [
        (DEFAULT, "support_vector_machine", (distances_to_units, "symmetric", False, SVC)),
        (DEFAULT, "k_nearest_neighbours", (distances_to_units, "symmetric", False, KNeighborsClassifier)),
        (FEATURE_GROUPS, "k_nearest_neighbours", (means_of_groups, "zero", True, lambda: KNeighborsClassifier(1))),
        (FEATURE_GROUPS, "support_vector_machine", (means_of_groups, "zero", True, lambda: SVC(kernel="linear"))),
    ],
)  # fmt: skip
def test_a_variant_is_what_scikit_learn_and_pywavelets_give(
    made, features, variant, classifier, how
):
    key = (variant, classifier, "reachable")
    names = ("variant", "classifier", "random_probing")
    (row,) = [row for row in made[0] if tuple(row[name] for name in names) == key]
    for strategy in ("fixation", "random"):
        expected = by_hand(features, strategy, *how)
        assert row["splits"] == len(expected) == 8
        assert row[strategy] == pytest.approx(expected.mean(), abs=1e-9)
        assert row[f"{strategy}_best_split"] == pytest.approx(expected.max(), abs=1e-9)
        reached = (expected >= TABLE_1[classifier][strategy]).mean()
        assert row[f"{strategy}_splits_reaching"] == pytest.approx(reached, abs=1e-9)


def test_a_variant_that_fails_stays_in_the_table_with_its_reason(made):
    rows, summary = made
    failed = [row for row in rows if row["variant"] == ONLINE_LATTICE]
    assert {row["classifier"] for row in failed} == set(TABLE_1)
    assert all("MiniSom" in row["error"] and row["fixation"] is None for row in failed)
    assert summary["failed"] == [ONLINE_LATTICE]
    assert summary["variants"] == 3


def test_one_variant_alone_has_the_figures_that_it_has_among_all(made, features, tmp_path):
    output = tmp_path / "variant.json"
    (condition,) = conditions(FEATURE_GROUPS)
    inputs = {"features": [features]}
    make_variant(StepInputs("variants", inputs, [output], RUN, condition=condition))
    own = [row | {"seconds": 0} for row in made[0] if row["variant"] == FEATURE_GROUPS]
    assert [row | {"seconds": 0} for row in json.loads(output.read_text())] == own
