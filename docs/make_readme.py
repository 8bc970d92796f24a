"""Fill the tables of README and docs/scaling.md from the last run and benchmarks: `make readme`."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from filling import DOCS, SETS, fill_page, read_json, share, table

from cues.kept import kept_cues_of
from cues.sentences import carries_sentence
from turned.kept import read_turned
from turned.leads import KeptLeads, question_sentence, read_kept_leads
from turned.rows import turned_rows
from variants.result import papers_pipeline_sentences
from variants.summary import kept_summary
from visuohaptic.evaluation.leads import Question
from visuohaptic.evaluation.published import TABLE_1
from visuohaptic.recognition.parameters import IntervalParameters
from visuohaptic.report.comparison import pipeline_tables
from visuohaptic.report.leads import Lead, run_leads
from visuohaptic.report.questions import QUESTIONS, Answer, lead_answer, recognition_answer
from visuohaptic.report.wording import POSES
from visuohaptic_workflow.closing import REPORT, describe_results

ROOT = DOCS.parent
UNSEEN = "unseen objects"
LABELS = {
    "k_nearest_neighbours": "kNN",
    "support_vector_machine": "SVM",
    "decision_tree": "decision tree",
    "quadratic_discriminant": "quadratic discriminant",
    "naive_bayes": "naïve Bayes",
    "linear_discriminant": "linear discriminant",
}
RUNS = {
    "cold_run": "cold `snakemake -j2`, meshes to report",
    "no_op": "nothing to do",
    "recognition_change": "after a change of recognition",
    "sensor_change": "after a change of the sensor",
}


def results_table(metrics: dict[str, Any]) -> str:
    """Set our accuracies, of `reports/metrics.json`, beside the published ones and those of the most literal variant."""
    literal, strategies = kept_summary().literal, ("fixation", "random")
    rows = []
    for classifier, label in LABELS.items():
        paper, ours = (
            [cell_of(metrics["results"][name][one], classifier) for one in strategies]
            for name in ("paper", "order_free")
        )
        published = [
            share(TABLE_1[classifier][one], 2) if classifier in TABLE_1 else ""
            for one in strategies
        ]
        read = [
            share(literal[one][classifier]) if classifier in literal[one] else ""
            for one in strategies
        ]
        rows.append([label, paper[0], published[0], paper[1], published[1], *read, *ours])
    heads = ["classifier", "eye fixations", "published", "random probing", "published"]
    heads += ["literal, fixations", "literal, random walk", "ours, fixations", "ours, random"]
    return table(heads, rows)


def cell_of(by_classifier: dict[str, Any], classifier: str) -> str:
    """Write the accuracy of a classifier, empty for a classifier that the pipeline does not have."""
    if classifier not in by_classifier:
        return ""
    return percent(by_classifier[classifier]["accuracy"])


def percent(interval: dict[str, float]) -> str:
    """Write a mean and its interval, 0 to 1 each, in per cent, such as ``64.0 % (50.9–77.7)``."""
    return f"{share(interval['mean'])} ({100 * interval['low']:.1f}–{100 * interval['high']:.1f})"


def turned_table() -> str:
    """Set kept accuracies by fixation in a row per pose of the objects, and a column per set and pipeline."""
    kept = read_turned()
    found = {
        name: turned_rows(kept[name], IntervalParameters())
        for name in sorted(kept, key="paper".__ne__)
    }
    heads, columns = ["objects are"], []
    for name, rows in found.items():
        for pipeline, label in (("paper", "the paper's pipeline"), ("order_free", "ours")):
            columns.append({row.turns: row.fixation for row in rows if row.pipeline == pipeline})
            heads.append(f"{SETS[name]}, {label}")
    rows = [
        [pose, *(percent(vars(one[turns])) if turns in one else "" for one in columns)]
        for turns, pose in POSES.items()
    ]
    return table(heads, rows)


def answers(metrics: dict[str, Any]) -> str:
    """Answer the questions of the experiment from the figures of twelve objects and the kept leads of 142."""
    tables = pipeline_tables(metrics)
    kept = read_kept_leads(IntervalParameters())
    if kept is None:
        raise FileNotFoundError("no leads of 142 objects are kept; run `make draws SET=benchmark`.")
    leads = run_leads(metrics, {one.name: one.headline.key for one in tables}, "none", "full")
    recognised = recognition_answer(
        tables,
        len(tables[0].best.class_accuracy["fixation"]),
        5,
        UNSEEN,
        caveats=(
            carries_sentence(kept_cues_of("paper"), IntervalParameters()),
            papers_pipeline_sentences(kept_summary()),
        ),
    )
    found = [
        *(_lead_lines(question, leads, kept) for question in QUESTIONS),
        _answer_lines(recognised),
    ]
    return "\n\n".join(found).replace("\N{NO-BREAK SPACE}", " ")


def _answer_lines(answer: Answer) -> str:
    """Write an answer as a paragraph and one list item per further sentence."""
    first = f"**{answer.question}** {answer.finding}: {answer.number} {answer.sentence}"
    lines = [_wrapped(first), ""] if answer.caveats else [_wrapped(first)]
    lines += [_wrapped(f"- {sentence}", "  ") for sentence in answer.caveats]
    return "\n".join(lines)


def _lead_lines(question: Question, leads: Sequence[Lead], kept: KeptLeads) -> str:
    """Write the answer on more objects as a paragraph, and the answer on the run's objects as a list item."""
    answer, more = lead_answer(question, leads), question_sentence(question, kept)
    first, *_ = answer.sentence.split(". ")
    own = f"- On the run's objects: {answer.finding[0].lower()}{answer.finding[1:]}; {answer.number} {first}."
    return "\n".join([_wrapped(f"**{answer.question}** {more}"), "", _wrapped(own, "  ")])


def _wrapped(text: str, indent: str = "") -> str:
    return textwrap.fill(text, 100, break_on_hyphens=False, subsequent_indent=indent)


def speed_table(results: dict[str, Any]) -> str:
    """Set the workflow's seconds, of `benchmarks/results.json`, in a table, the machine named in a sentence."""
    workflow, machine = results["workflow"], results["machine"]
    alone = workflow["paper_pipeline"]
    rows = []
    for name, label in RUNS.items():
        paper = f"{alone[f'{name}_s']:.1f} s" if f"{name}_s" in alone else ""
        spent = f"{workflow[f'{name}_cpu_s']:.1f} s"
        rows.append([label, f"{workflow[f'{name}_s']:.1f} s", spent, paper])
    sentence = (
        f"On {machine['processor']}, {machine['cores']} cores, load {workflow['load_before']} before, "
        f"with bytecode; {workflow['jobs']} jobs in a cold run. `make bench` measures again."
    )
    measured = table(["run", "both pipelines", "processor time", "the paper's only"], rows)
    return f"{measured}\n\n{textwrap.fill(sentence, 100, break_on_hyphens=False)}"


def printed_lines(metrics: Path) -> str:
    """Return the figures of `reports/metrics.json` as `make` prints them at its end, a Markdown block."""
    lines = [*describe_results(metrics, "none"), f"The report is at {REPORT}."]
    return "\n".join(["```text", *lines, "```"])


if __name__ == "__main__":
    metrics = ROOT / "reports" / "metrics.json"
    found = read_json(metrics)
    blocks = {
        "results": results_table(found),
        "answers": answers(found),
        "turned": turned_table(),
    }
    fill_page(ROOT / "README.md", {**blocks, "make": printed_lines(metrics)})
    timed = read_json(ROOT / "benchmarks" / "results.json")
    fill_page(DOCS / "scaling.md", {"speed": speed_table(timed)})
