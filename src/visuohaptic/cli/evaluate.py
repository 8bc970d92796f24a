"""`visuohaptic evaluate`: accuracy of a model or a classifier on objects that are not in its training set."""

from __future__ import annotations

import warnings
from collections.abc import Mapping, Sequence
from enum import StrEnum
from functools import partial
from pathlib import Path
from typing import Annotated, Any

import typer

from visuohaptic.base.errors import RecognitionWarning
from visuohaptic.cli.printing import JsonOption, file_to_read, say, say_json
from visuohaptic.cli.settings import SetOption, read_parameters_and_settings
from visuohaptic.exploration.recognising import DEFAULT_MODEL, default_model, read_recogniser

TABLE = "reports/evaluation.parquet"

# The help text of these options names the default.
_option = partial(typer.Option, show_default=False)


class InputsName(StrEnum):
    """Names of the inputs in `visuohaptic.evaluation.inputs`."""

    features = "features"
    descriptors = "descriptors"
    touches = "touches"


def evaluate(
    models: Annotated[
        list[Path] | None,
        typer.Argument(
            metavar="[MODEL]...",
            parser=file_to_read,
            help=f"Fitted recognition models, one per strategy.  [default: {DEFAULT_MODEL}]",
            show_default=False,
        ),
    ] = None,
    run: Annotated[
        Path,
        typer.Option(help="Folder of the run; results/features has the objects.", show_default="."),
    ] = Path(),
    classifier: Annotated[
        str | None,
        _option(
            help="Registered classifier to train and test on the splits of the run, instead of a fitted model."
        ),
    ] = None,
    inputs: Annotated[
        InputsName | None,
        _option(
            help="Input of --classifier per sequence: the paper's features, the descriptors of pipeline order_free, "
            "or imprints and poses of the touches.  [default: features]"
        ),
    ] = None,
    strategy: Annotated[
        str | None,
        _option(help="Probing strategy of the touches for --classifier.  [default: fixation]"),
    ] = None,
    splits: Annotated[
        int | None,
        _option(min=1, help="Largest number of splits for --classifier.  [default: all]"),
    ] = None,
    settings: SetOption = None,
    as_json: JsonOption = False,  # noqa: FBT002
) -> None:
    """Classify the objects of a run that are not in the training set, and count correct predictions.

    With a model: classifies from 1, 4 and 16 views. Prints the share of objects that is correctly classified, and
    the share with its class in the prediction set, beside the stated coverage. Also prints the mean size of the
    sets and the share called unknown. Intervals are over objects. The touches must come from the parameters in
    the model's folder. The rows are written to reports/evaluation.parquet, for the report.

    With --classifier: trains and tests a classifier on the splits of the run, with the run's params.yaml and the
    values of --set. Prints the accuracy with its interval, and the seconds of fits and predictions. A classifier of imprints and poses
    comes from a plug-in.

    Examples: visuohaptic evaluate results/models/recogniser.skops --run .
    visuohaptic evaluate --classifier linear_discriminant --inputs descriptors
    """
    if classifier is not None:
        if models:
            raise typer.BadParameter(
                "a model and --classifier exclude each other; name only one of them."
            )
        _evaluate_classifier(
            classifier,
            run,
            inputs or InputsName.features,
            strategy,
            splits,
            settings,
            as_json=as_json,
        )
        return
    needing = {
        "--inputs": inputs,
        "--strategy": strategy,
        "--splits": splits,
        "--set": settings or None,
    }
    for name, value in needing.items():
        if value is not None:
            raise typer.BadParameter(f"{name} needs --classifier.")
    _evaluate_models(models or [default_model()], run, as_json=as_json)


def _evaluate_models(files: Sequence[Path], run: Path, *, as_json: bool) -> None:
    import pyarrow as pa

    from visuohaptic.evaluation.held_out import evaluate_model, summarise_evaluation
    from visuohaptic.tables.phases import FEATURES
    from visuohaptic.tables.schema import read_table, write_table
    from visuohaptic.tables.studies import EVALUATION

    models = [read_recogniser(file).model for file in files]
    features = read_table(FEATURES, run / "results/features")
    table = pa.concat_tables(evaluate_model(model, features) for model in models)
    write_table(EVALUATION, table, run / TABLE)
    rows = summarise_evaluation(table, models[0].parameters.intervals)
    if as_json:
        say_json(rows)
        return
    for model in models:
        for name in model.strategies:
            say(f"Touches by {name}, a model trained on {len(model.objects)} objects:")
            for row in rows:
                if row["strategy"] == name:
                    say(_result_line(row))
    say(f"{run / TABLE}")


def _evaluate_classifier(
    name: str,
    run: Path,
    inputs: InputsName,
    strategy: str | None,
    splits: int | None,
    settings: list[str] | None,
    *,
    as_json: bool,
) -> None:
    from visuohaptic.evaluation.evaluating import evaluate as evaluate_classifier

    params_file = run / "params.yaml"
    parameters = read_parameters_and_settings(
        params_file if params_file.exists() else None, settings
    )
    table = "touches" if inputs == InputsName.touches else "features"
    strategy = "fixation" if strategy is None else strategy
    with warnings.catch_warnings():
        # The command prints the notes as lines.
        warnings.simplefilter("ignore", RecognitionWarning)
        evaluation = evaluate_classifier(
            name,
            run / "results" / table,
            parameters.recognition,
            strategy,
            parameters.seed,
            inputs=inputs.value,
            splits=splits,
        )
    accuracy = [evaluation.accuracy, evaluation.low, evaluation.high]
    if as_json:
        row = {
            "classifier": name, "inputs": inputs.value, "strategy": strategy,
            "accuracy": accuracy,
            "objects": len(evaluation.by_object), "splits": evaluation.splits,
            "fit": vars(evaluation.fit), "predict": vars(evaluation.predict),
            "notes": evaluation.notes,
        }  # fmt: skip
        say_json(row)
        return
    say(
        f"{name} on {inputs.value} of touches by {strategy}: {_percent(accuracy)} correctly classified, "
        f"{len(evaluation.by_object)} objects, {evaluation.splits} splits"
    )
    for note in evaluation.notes:
        say(f"  note: {note}")
    say(f"  fits took {evaluation.fit}, predictions {evaluation.predict}")


def _result_line(row: Mapping[str, Any]) -> str:
    views = f"{row['views']:>2} {'view' if row['views'] == 1 else 'views'}"
    line = (
        f"  {views}: {_percent(row['accuracy'])} correctly classified; the class is in "
        f"{_percent(row['coverage'])} of the sets, stated {100 * row['stated']:g} %, with "
        f"{row['set_size']:.2f} classes on average; {_percent(row['false_unknown'])} called unknown"
    )
    if "found_unknown" in row:
        line += f"; of objects of unknown classes, {_percent(row['found_unknown'])} called unknown"
    return line


def _percent(interval: Sequence[float | None]) -> str:
    # A single object has no interval.
    mean, *ends = (100 * value for value in interval if value is not None)
    return f"{mean:.1f} %" + (" ({:.1f} to {:.1f})".format(*ends) if ends else "")
