"""Words of the page are explained as in docs/glossary.md, once a text, and names stay text."""

from pathlib import Path

import pytest

from visuohaptic.report.glossary import WORDS, explained

GLOSSARY = Path(__file__).parents[2] / "docs" / "glossary.md"


@pytest.mark.parametrize("word", WORDS)
def test_a_word_means_what_the_glossary_says(word):
    rows = [line.strip("| ").split(" | ") for line in GLOSSARY.read_text("utf-8").splitlines()]
    meanings = {row[0].split(" (")[0]: row[1] for row in rows if len(row) == 2}
    assert meanings[word] == WORDS[word]


def test_the_first_use_of_a_word_is_explained_and_no_later_one():
    text = explained("Fixations, a fixation, and one imprint.")
    assert text.count("<abbr") == 2
    assert "s, a fixation, and" in text


def test_names_are_escaped_first_and_parts_of_words_are_left_alone():
    assert explained("<b>split</b> & 'x'").startswith("&lt;b&gt;<abbr")
    assert "<abbr" not in explained("splitting, rereadings, effective")
