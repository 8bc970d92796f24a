"""Sentences follow the figures."""

from visuohaptic.report.comparison import agreement, answer, merge_notes, read_tables


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


def test_answer_has_three_sentences_with_the_figures():
    sentences = answer([table()], 4, 5, "an unknown object", 0.95)
    assert len(sentences) == 3
    assert "names the class of an unknown object in 93.0\xa0%" in sentences[0]
    assert "88.0\xa0% to 98.0\xa0%" in sentences[0]
    assert "guessing among 4 classes gives 25.0\xa0%" in sentences[0]
    assert "above that of random probing with 1 of 2 classifiers" in sentences[1]
    assert "significant for support vector machine (+13.0)" in sentences[1]
    assert "93.45\xa0%" in sentences[2]
    assert "1 of its 2 figures" in sentences[2]


def test_answer_says_when_nothing_is_beyond_chance():
    sentences = answer([table(p_values=(0.03, 0.6))], 4, 5, "an unknown object", 0.95)
    assert "no difference is significant (smallest Holm-adjusted p 0.06)" in sentences[1]


def test_agreement_and_disagreement_are_told_apart():
    agrees, differs = agreement(table())
    assert any("within the interval found here for support vector machine" in s for s in agrees)
    assert any("sign of the difference is the published one for" in s for s in agrees)
    assert any("best classifier" in s and "in both" in s for s in agrees)
    assert any(
        "outside the interval found here for naïve Bayes: here minus published is −26.7" in s
        for s in differs
    )


def test_other_ranks_and_signs_are_disagreements():
    agrees, differs = agreement(table(fixation=(0.3, 0.6), random=(0.4, 0.5)))
    assert not any("sign of the difference is the published" in s for s in agrees)
    assert any(
        "is not the published one for support vector machine and naïve" in s for s in differs
    )
    assert any("is the naïve Bayes here and the support vector machine in" in s for s in differs)


def test_only_the_papers_pipeline_stands_beside_the_paper():
    figures = metrics({SVM: 0.9}, {SVM: 0.8}, {SVM: 0.5})
    figures["results"]["best"] = figures["results"]["paper"]
    tables = read_tables(figures)
    assert [table.name for table in tables] == ["paper", "best"]
    assert tables[0].rows[0].published
    assert not tables[1].rows[0].published
    sentences = answer(tables, 4, 5, "an unknown object", 0.95)
    assert len(sentences) == 3
    assert "from the same touches pipeline best reaches 90.0" in sentences[0]


def test_notes_that_differ_in_a_number_are_one():
    notes = {"chosen: tree_leaf 8", "chosen: tree_leaf 1", "singular: shrunk", "chosen: c 1e-05"}
    assert merge_notes(notes) == (
        "chosen: c 1e-05", "chosen: tree leaf 1 or 8", "singular: shrunk",
    )  # fmt: skip
    assert merge_notes([]) == ()
