"""Sentences follow the figures."""

from visuohaptic.report.comparison import gain_sentence, merge_notes, read_tables


def interval(mean, half=0.05):
    return {"mean": mean, "low": mean - half, "high": mean + half}


def cell(mean, half=0.05):
    return {
        "accuracy": interval(mean, half),
        "object_accuracy": interval(mean),
        "balanced_accuracy": interval(mean),
        "class_accuracy": {"cup": interval(mean)},
        "splits": 81,
        "repeats": 1,
        "objects": 12,
        "sequences": 192,
        "notes": [],
    }


def metrics(fixation, random, p_values):
    """Give metrics of classifiers by their accuracies and p values."""
    return {
        "results": {
            "paper": {
                "fixation": {name: cell(mean) for name, mean in fixation.items()},
                "random": {name: cell(mean) for name, mean in random.items()},
            }
        },
        "comparisons": {
            "paper": {
                name: {
                    "random": {
                        "difference": interval(fixation[name] - random[name]),
                        "p_value": p_values[name],
                        "objects": 12,
                        "exact": True,
                    }
                }
                for name in fixation
            }
        },
    }


SVM, BAYES = "support_vector_machine", "naive_bayes"


def table(fixation=(0.93, 0.3), random=(0.8, 0.4), p_values=(0.001, 0.6)):
    names = (SVM, BAYES)
    return read_tables(
        metrics(*(dict(zip(names, values, strict=True)) for values in (fixation, random, p_values)))
    )[0]


def test_rows_follow_the_published_table():
    assert [row.key for row in table().rows] == [SVM, BAYES]
    assert table().best.key == SVM


def test_the_gain_is_said_with_what_is_significant():
    sentence = gain_sentence(table())
    assert "Fixations are ahead of random probing with 1 of 2 classifiers" in sentence
    assert "significant for support vector machine (+13.0)" in sentence


def test_the_gain_is_said_to_be_insignificant_where_it_is():
    sentence = gain_sentence(table(p_values=(0.03, 0.6)))
    assert "no difference is significant (smallest Holm-adjusted p 0.06)" in sentence


def test_only_the_papers_pipeline_stands_beside_the_paper():
    figures = metrics({SVM: 0.9}, {SVM: 0.8}, {SVM: 0.5})
    figures["results"]["best"] = figures["results"]["paper"]
    tables = read_tables(figures)
    assert [table.name for table in tables] == ["paper", "best"]
    assert tables[0].rows[0].published
    assert not tables[1].rows[0].published


def test_notes_that_differ_in_a_number_are_one():
    notes = {"chosen: tree_leaf 8", "chosen: tree_leaf 1", "singular: shrunk", "chosen: c 1e-05"}
    assert merge_notes(notes) == (
        "chosen: c 1e-05", "chosen: tree leaf 1 or 8", "singular: shrunk",
    )  # fmt: skip
    assert merge_notes([]) == ()
