"""`visuohaptic evaluate`: how right a model or a classifier is on objects that it has not learnt."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from enum import StrEnum
from pathlib import Path
from typing import Annotated, Any

import typer

from visuohaptic.cli.printing import JsonOption, file_to_read, say, say_json
from visuohaptic.exploration.recognising import DEFAULT_MODEL, default_model, read_recogniser

TABLE = "reports/evaluation.parquet"


class InputsName(StrEnum):
    """Kinds of input of `visuohaptic.evaluation.inputs`."""

    features = "features"
    descriptors = "descriptors"
    touches = "touches"


def evaluate(
    models: Annotated[
        list[Path] | None,
        typer.Argument(
            metavar="[MODEL]...",
            parser=file_to_read,
            help=f"Fitted recognition models, one a strategy.  [default: {DEFAULT_MODEL}]",
            show_default=False,
        ),
    ] = None,
    run: Annotated[
        Path, typer.Option(help="Folder whose results/features has the objects.", show_default=".")
    ] = Path(),
    classifier: Annotated[
        str | None,
        typer.Option(
            help="Registered classifier to train and test on the run's splits, instead of a fitted model.",
            show_default=False,
        ),
    ] = None,
    inputs: Annotated[
        InputsName | None,
        typer.Option(
            help="What --classifier gets per sequence: the paper's features, our descriptors, or imprints and "
            "poses of the touches.  [default: features]",
            show_default=False,
        ),
    ] = None,
    strategy: Annotated[
        str | None,
        typer.Option(
            help="How the touches of --classifier were chosen.  [default: fixation]",
            show_default=False,
        ),
    ] = None,
    splits: Annotated[
        int | None,
        typer.Option(
            min=1,
            help="At most so many splits of --classifier.  [default: all]",
            show_default=False,
        ),
    ] = None,
    as_json: JsonOption = False,  # noqa: FBT002
) -> None:
    """Classify the objects of a run that a model or a classifier has not learnt, and count correct answers.

    With a model: prints the share correctly classified, the share whose class is in the prediction set, beside
    what that states, the set's mean size, and the share called unknown, from 1, 4 and 16 views, with intervals
    over objects. They must be touched with the parameters that lie beside the model. The rows are written to
    reports/evaluation.parquet, and the report shows them.

    With --classifier: trains and tests a classifier on the splits of the run, by its params.yaml, and prints its
    accuracy with interval and the seconds that fits and predictions took. A classifier that takes imprints and
    poses comes from a plug-in.

    Examples: visuohaptic evaluate results/models/recogniser.skops --run .
    visuohaptic evaluate --classifier linear_discriminant --inputs descriptors
    """
    if classifier is not None:
        if models:
            raise typer.BadParameter("a model and --classifier exclude each other.")
        _evaluate_classifier(
            classifier, run, inputs or InputsName.features, strategy, splits, as_json=as_json
        )
        return
    for name, value in {"--inputs": inputs, "--strategy": strategy, "--splits": splits}.items():
        if value is not None:
            raise typer.BadParameter(f"{name} needs --classifier.")
    import pyarrow as pa

    from visuohaptic.studies.evaluation.models import evaluate_model, summarise_evaluation
    from visuohaptic.tables.phases import FEATURES
    from visuohaptic.tables.schema import read_table, write_table
    from visuohaptic.tables.studies import EVALUATION

    recognisers = [read_recogniser(model) for model in models or [default_model()]]
    features = read_table(FEATURES, run / "results/features")
    table = pa.concat_tables(evaluate_model(one.model, features) for one in recognisers)
    write_table(EVALUATION, table, run / TABLE)
    first = recognisers[0]
    rows = summarise_evaluation(table, first.model.parameters.intervals)
    if as_json:
        say_json(rows)
        return
    for one in recognisers:
        learnt = len(one.model.objects)
        for name in one.model.strategies:
            say(f"Touches by {name}, a model that learnt {learnt} objects:")
            for row in rows:
                if row["strategy"] == name:
                    say(_line(row))
    say(f"{run / TABLE}")


def _evaluate_classifier(
    name: str,
    run: Path,
    inputs: InputsName,
    strategy: str | None,
    splits: int | None,
    *,
    as_json: bool,
) -> None:
    from visuohaptic.evaluation.evaluating import evaluate as evaluate_classifier
    from visuohaptic.parameters import ExperimentParameters, read_parameters

    own = run / "params.yaml"
    parameters = read_parameters(own) if own.exists() else ExperimentParameters()
    table = "touches" if inputs == InputsName.touches else "features"
    chosen = "fixation" if strategy is None else strategy
    found = evaluate_classifier(
        name,
        run / "results" / table,
        parameters.recognition,
        chosen,
        parameters.seed,
        inputs=inputs.value,
        splits=splits,
    )
    if as_json:
        row = {
            "classifier": name, "inputs": inputs.value, "strategy": chosen,
            "accuracy": [found.accuracy, found.low, found.high],
            "objects": len(found.by_object), "splits": found.splits,
            "fit": vars(found.fit), "predict": vars(found.predict),
        }  # fmt: skip
        say_json(row)
        return
    interval = _share([found.accuracy, found.low, found.high])
    say(
        f"{name} on {inputs.value} of touches by {chosen}: {interval} correctly classified, "
        f"{len(found.by_object)} objects, {found.splits} splits"
    )
    say(f"  fits took {found.fit}, predictions {found.predict}")


def _line(row: Mapping[str, Any]) -> str:
    views = f"{row['views']:>2} {'view' if row['views'] == 1 else 'views'}"
    line = (
        f"  {views}: {_share(row['accuracy'])} correctly classified; the class is in "
        f"{_share(row['coverage'])} of the sets, stated {100 * row['stated']:g} %, with "
        f"{row['set_size']:.2f} classes on average; {_share(row['false_unknown'])} called unknown"
    )
    if "found_unknown" in row:
        line += f"; of classes that it does not know, {_share(row['found_unknown'])} called unknown"
    return line


def _share(interval: Sequence[float | None]) -> str:
    # A single object has no interval.
    mean, *ends = (100 * value for value in interval if value is not None)
    return f"{mean:.1f} %" + (" ({:.1f} to {:.1f})".format(*ends) if ends else "")
