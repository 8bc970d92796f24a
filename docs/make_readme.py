"""Fill the tables of README and docs/scaling.md from the last run and benchmarks: `make readme`."""

from __future__ import annotations

import json
import re
import textwrap
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from visuohaptic.recognition.published import TABLE_1
from visuohaptic.report.comparison import read_tables
from visuohaptic.report.questions import fixation_answer, readings_sentence, recognition_answer
from visuohaptic.report.readings import read_readings
from visuohaptic_workflow.closing import REPORT, describe_results

ROOT = Path(__file__).parents[1]
UNSEEN = "unseen objects"
LABELS = {
    "k_nearest_neighbours": "kNN",
    "support_vector_machine": "SVM",
    "decision_tree": "decision tree",
    "quadratic_discriminant": "quadratic discriminant",
    "naive_bayes": "naïve Bayes",
}
RUNS = {
    "cold_run": "cold `snakemake -j2`, meshes to report",
    "no_op": "nothing to do",
    "recognition_change": "after a change of recognition",
    "sensor_change": "after a change of the sensor",
}


def results_table(metrics: dict[str, Any]) -> str:
    """Set our accuracies, of `reports/metrics.json`, beside the published ones."""
    lines = [
        "| classifier | eye fixations | published | random probing | published | literal, fixations | literal, random walk | ours, fixations | ours, random |",
        "|---|---|---|---|---|---|---|---|---|",
    ]
    literal = literal_reading()
    strategies, best = metrics["results"]["paper"], metrics["results"]["best"]
    for classifier, label in LABELS.items():
        published = TABLE_1[classifier]
        figures = [
            percent(pipeline[name][classifier]["accuracy"])
            for pipeline in (strategies, best)
            for name in ("fixation", "random")
        ]
        lines.append(
            f"| {label} | {figures[0]} | {100 * published['fixation']:.2f} % "
            f"| {figures[1]} | {100 * published['random']:.2f} % "
            f"| {literal['fixation'][classifier]} | {literal['random'][classifier]} "
            f"| {figures[2]} | {figures[3]} |"
        )
    return "\n".join(lines)


def literal_reading() -> dict[str, dict[str, str]]:
    """Give the accuracies of the most literal reading, by strategy and classifier, as kept with the package."""
    return {
        strategy: {name: f"{100 * accuracy:.1f} %" for name, accuracy in found.items()}
        for strategy, found in read_readings().literal.items()
    }


def percent(interval: dict[str, float]) -> str:
    """Write a mean and its interval, 0 to 1 each, in per cent, such as ``64.0 % (50.9–77.7)``."""
    return f"{interval['mean']:.1%} ({100 * interval['low']:.1f}–{100 * interval['high']:.1f})".replace(
        "%", " %"
    )


def answers(metrics: dict[str, Any]) -> str:
    """Answer the two questions of the experiment from its figures and the kept readings."""
    tables = read_tables(metrics)
    readings = read_readings()
    found = (
        recognition_answer(tables, len(tables[0].best.class_accuracy["fixation"]), 5, UNSEEN),
        fixation_answer(tables, readings),
    )
    sentences = [
        f"**{one.question}** {one.word}: {one.number} {one.sentence}" for one in found if one
    ]
    sentences[-1] += f" {readings_sentence(readings)}"
    text = "\n\n".join(
        textwrap.fill(sentence, 100, break_on_hyphens=False) for sentence in sentences
    )
    return text.replace("\N{NO-BREAK SPACE}", " ")


def speed_table(results: dict[str, Any]) -> str:
    """Set the workflow's seconds, of `benchmarks/results.json`, in a table, the machine named in a sentence."""
    workflow, machine = results["workflow"], results["machine"]
    alone = workflow["paper_pipeline"]
    lines = ["| run | both pipelines | of processors | the paper's alone |", "|---|---|---|---|"]
    for name, label in RUNS.items():
        paper = f"{alone[f'{name}_s']:.1f} s" if f"{name}_s" in alone else ""
        # Figures of before `make bench` counted processors have none of these.
        of_processors = workflow.get(f"{name}_cpu_s")
        spent = "not counted" if of_processors is None else f"{of_processors:.1f} s"
        lines.append(f"| {label} | {workflow[f'{name}_s']:.1f} s | {spent} | {paper} |")
    how = (
        f", load {workflow['load_before']} before, with bytecode"
        if "load_before" in workflow
        else ""
    )
    sentence = (
        f"On {machine['processor']}, {machine['cores']} cores{how}; {workflow['jobs']} jobs in a cold run. "
        "`make bench` measures again."
    )
    return "\n".join([*lines, "", textwrap.fill(sentence, 100, break_on_hyphens=False)])


def printed_lines(metrics: Path) -> str:
    """Give the figures of `reports/metrics.json` as `make` prints them at its end, a Markdown block."""
    lines = [*describe_results(metrics, "none"), f"The report is at {REPORT}."]
    return "\n".join(["```text", *lines, "```"])


def fill_page(page: Path, blocks: Mapping[str, str]) -> None:
    """Replace what stands between the two markers of each block of a page."""
    text = page.read_text(encoding="utf-8")
    for name, content in blocks.items():
        text = fill(text, name, content)
    page.write_text(text, encoding="utf-8")


def fill(text: str, name: str, content: str) -> str:
    """Replace what stands between ``<!-- name -->`` and ``<!-- /name -->`` in a page."""
    pattern = re.compile(rf"(<!-- {name} -->\n).*?(<!-- /{name} -->)", re.DOTALL)
    filled, found = pattern.subn(lambda match: f"{match[1]}{content}\n{match[2]}", text)
    if not found:
        raise SystemExit(f"The page has no block {name}; `<!-- {name} -->` is needed.")
    return filled


def main() -> None:
    """Fill all blocks of the README, and the run times of docs/scaling.md."""
    metrics = ROOT / "reports" / "metrics.json"
    found = json.loads(metrics.read_text(encoding="utf-8"))
    timed = json.loads((ROOT / "benchmarks" / "results.json").read_text(encoding="utf-8"))
    pages = {
        "README.md": {
            "results": results_table(found),
            "answers": answers(found),
            "make": printed_lines(metrics),
        },
        "docs/scaling.md": {"speed": speed_table(timed)},
    }
    for name, blocks in pages.items():
        fill_page(ROOT / name, blocks)


if __name__ == "__main__":
    main()
