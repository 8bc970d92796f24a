"""A model to classify objects with: quick to fit, and without sense."""

from recognition.synthetic import features_table

from visuohaptic.parameters import ExperimentParameters
from visuohaptic.recognition.model_of_run import make_model
from visuohaptic.recognition.parameters import RecognitionParameters
from visuohaptic.tables.phases import FEATURES
from visuohaptic.tables.schema import join_parts, write_table

SMALL = {"rendering": {"resolution": 64}, "viewpoints": {"count": 2}}


def fit_on_nonsense(folder, strategies=("fixation",), objects=(2, 2)):
    """Leave a model that learnt numbers without sense, with parameters that have some."""
    folder.mkdir(parents=True, exist_ok=True)
    tables = [features_table(name, objects=objects, viewpoints=3) for name in strategies]
    write_table(FEATURES, join_parts(FEATURES, tables), folder / "features.parquet")
    make_model(
        features=[folder / "features.parquet"],
        model=folder / "recogniser.skops",
        pipeline="order_free",
        classifier="linear_discriminant",
        strategies=strategies,
        recognition=RecognitionParameters(),
        touching=ExperimentParameters.from_mapping(SMALL).model_dump(
            mode="json", exclude={"recognition", "workflow"}
        ),
        seed=1,
    )
    return folder / "recogniser.skops"
