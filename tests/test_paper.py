"""The paper about the software has the form that its journal asks for, and reports no new results."""

import re
from pathlib import Path

import pytest
import yaml

ROOT = Path(__file__).parents[1]
TEXT = (ROOT / "paper/paper.md").read_text(encoding="utf-8")
HEADER, BODY = re.fullmatch(r"---\n(.*?)\n---\n(.*)", TEXT, re.DOTALL).groups()
BIBLIOGRAPHY = (ROOT / "paper/paper.bib").read_text(encoding="utf-8")
ENTRIES = {
    key: dict(re.findall(r"^  (\w+) *= \{(.*)\},$", fields, re.M))
    for key, fields in re.findall(r"^@\w+\{(\w+),\n(.*?)^\}", BIBLIOGRAPHY, re.M | re.DOTALL)
}
# joss.readthedocs.io, "JOSS paper format", as of 2026.
SECTIONS = [
    "Summary", "Statement of need", "State of the field", "Software design",
    "Research impact statement", "AI usage disclosure", "Acknowledgements", "References",
]  # fmt: skip
WORDS = (750, 1750)


def words_of(text):
    """List the words of the paper: without comments, marks of citations and pictures, with captions."""
    for pattern, kept in (
        (r"<!--.*?-->", " "),
        (r"\[@[^\]]*\]", " "),
        (r"\\(?:auto)?(?:ref|label)\{[^}]*\}", " "),
        (r"!\[(.*?)\]\([^)]*\)", r"\1"),
    ):
        text = re.sub(pattern, kept, text, flags=re.DOTALL)
    return re.findall(r"[^\W_][\w'’.-]*", text)


def test_words_are_counted_as_a_reader_would():
    text = "One `two` [@a; @b], *three*-part.\n\n<!-- none -->\n\n![Four five.\\label{x}](six.png)"
    assert words_of(text) == ["One", "two", "three", "part.", "Four", "five."]


def test_the_paper_is_as_long_as_the_journal_allows():
    lowest, highest = WORDS
    assert lowest <= len(words_of(BODY)) <= highest


def test_the_header_has_the_fields_of_the_journal():
    header = yaml.safe_load(HEADER)
    assert {"title", "tags", "authors", "affiliations", "date", "bibliography"} <= set(header)
    assert re.fullmatch(r"\d{1,2} [A-Z][a-z]+ \d{4}", header["date"])
    known = {str(one["index"]) for one in header["affiliations"]}
    for author in header["authors"]:
        assert set(str(author["affiliation"]).split(", ")) <= known
    assert (ROOT / "paper" / header["bibliography"]).is_file()


def test_the_sections_are_those_that_the_journal_asks_for():
    assert re.findall(r"^# (.*)$", BODY, re.M) == SECTIONS


def test_what_only_persons_can_say_is_marked_as_blank_or_filled():
    for section in ("AI usage disclosure", "Acknowledgements"):
        content = re.search(rf"^# {section}\n(.*?)(?=^# )", BODY, re.M | re.DOTALL)[1]
        assert content.strip()
    comments = re.findall(r"<!--(.*?)-->", TEXT, re.DOTALL)
    assert all(one.startswith(" to be filled by the persons who submit: ") for one in comments)


def test_every_citation_has_an_entry_and_every_entry_is_cited():
    cited = set(re.findall(r"@(\w+)", " ".join(re.findall(r"\[(@[^\]]*)\]", BODY))))
    assert len(cited) > 10
    assert cited == set(ENTRIES)


@pytest.mark.parametrize("key", ENTRIES)
def test_an_entry_names_author_title_year_and_where_it_is(key):
    entry = ENTRIES[key]
    assert {"author", "title", "year"} <= set(entry)
    assert re.fullmatch(r"(19|20)\d\d", entry["year"])
    if "doi" in entry:
        assert re.fullmatch(r"10\.\d{4,9}/[\w.()/:;-]+", entry["doi"])
    else:
        assert re.fullmatch(r"https://\S+", entry["url"])


def test_no_result_of_the_experiment_is_reported():
    text = BODY.replace("Tactile Gym 2.0", "")
    # A figure with a decimal or a share would need a source of its own; an exponent has none.
    assert re.findall(r"\d+\.\d|\d+ ?%", text) == []


def test_its_picture_is_that_of_the_readme():
    picture = re.search(r"^!\[.*?\]\((\S+?)\)", BODY, re.M | re.DOTALL)[1]
    shown = (ROOT / "docs/pictures" / picture).read_bytes()
    # A comparison of long bytes by pytest does not end.
    is_same = (ROOT / "paper" / picture).read_bytes() == shown
    assert is_same, "run `make paper`"
