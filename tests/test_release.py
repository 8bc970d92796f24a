"""Version, date, address and authors of a release stand in release/facts.yaml, and all files agree with it."""

import json
import re
import runpy
import tomllib
from pathlib import Path

import pytest
import yaml
from packaging.requirements import Requirement

import contourlets
import meshreaders
import visuohaptic

ROOT = Path(__file__).parents[1]
WRITER = runpy.run_path(str(ROOT / "release/write_files.py"))
FACTS = WRITER["read_facts"]()
PROJECTS = {
    folder: tomllib.loads((ROOT / folder / "pyproject.toml").read_text())
    for folder in (".", "packages/contourlets", "packages/meshreaders", "src/visuohaptic/attention")
}
PUBLISHED = {
    "address": "https://example.org/group/visuohaptic",
    "doi": "10.5281/zenodo.1234567",
    "contact": "conduct@example.org",
    "authors": [
        {
            "family-names": "Doe", "given-names": "Jane",
            "orcid": "0000-0002-1825-0097", "affiliation": "University of X, Country",
        },
        {"family-names": "Roe", "given-names": "Max", "affiliation": "University of X, Country"},
    ],
}  # fmt: skip
# Zenodo's fields for software, of those that its deposit form knows.
ZENODO_FIELDS = {
    "access_right", "communities", "contributors", "creators", "description", "doi", "grants",
    "keywords", "language", "license", "notes", "publication_date", "references",
    "related_identifiers", "title", "upload_type", "version",
}  # fmt: skip


def filled(**changes):
    """Return the content of all files for other facts, by path."""
    facts = type(FACTS).model_validate(
        {**FACTS.model_dump(by_alias=True), **changes}  # the same but for the changes
    )
    files = WRITER["release_files"](facts)
    return {path.relative_to(ROOT).as_posix(): text for path, text in files}


def test_every_file_holds_the_facts_of_the_release():
    changed = [name for name, text in filled().items() if text != (ROOT / name).read_text()]
    assert changed == [], "run `make release`"


def test_all_distributions_have_the_version_of_the_release():
    for package in (visuohaptic, contourlets, meshreaders):
        assert package.__version__ == FACTS.version
    for folder in (".", "packages/contourlets", "packages/meshreaders"):
        assert PROJECTS[folder]["project"]["dynamic"] == ["version"]
        path = ROOT / folder / PROJECTS[folder]["tool"]["hatch"]["version"]["path"]
        assert f'__version__ = "{FACTS.version}"' in path.read_text().splitlines()
    assert PROJECTS["src/visuohaptic/attention"]["project"]["version"] == FACTS.version


@pytest.mark.parametrize("name", ["contourlets", "meshreaders"])
def test_the_library_asks_for_its_packages_of_its_own_minor_version(name):
    wanted = map(Requirement, PROJECTS["."]["project"]["dependencies"])
    bound = next(one.specifier for one in wanted if one.name == name)
    major, minor, _ = FACTS.version.split(".")
    assert str(bound) == f">={major}.{minor}"


def test_the_changelog_begins_with_the_release():
    headings = re.findall(r"^## (.*)$", (ROOT / "CHANGELOG.md").read_text(), re.M)
    released = [heading for heading in headings if heading != "Unreleased"]
    assert released[0] == f"{FACTS.version} ({FACTS.date.isoformat()})"


def test_tests_that_the_makefile_names_are_there():
    named = re.findall(r"(?<![\w/])(?:tests|packages)/[\w/.-]+", (ROOT / "Makefile").read_text())
    assert len(named) > 5
    assert [name for name in named if not (ROOT / name).exists()] == []


def test_make_test_says_its_minutes_and_leaves_linters_to_make_check_and_continuous_integration():
    text = (ROOT / "Makefile").read_text()
    recipes = dict(re.findall(r"^([\w-]+):(.*\n(?:\t.*\n)+)", text, re.M))
    first, said, *_ = recipes["test"].splitlines()
    assert "lint" not in first
    assert re.search(r"echo .* \d+ minutes", said)
    for target in ("check", "test-all"):
        assert recipes[target].splitlines()[0].split() == ["lint"]
    assert "make test-all" in (ROOT / ".ci/run").read_text().splitlines()


def test_another_version_reaches_every_place():
    for name, text in filled(version="7.8.9").items():
        if name not in {"README.md", "CONTRIBUTING.md", "SUPPORT.md", "CODE_OF_CONDUCT.md"}:
            assert ("7.8.9" in text) == (FACTS.version in (ROOT / name).read_text()), name


def test_pages_show_a_blank_until_the_address_is_known_and_then_the_address():
    pages = [*ROOT.glob("*.md"), *ROOT.glob("docs/*.md"), *ROOT.glob("packages/*/**/*.md")]
    clones = {
        path.relative_to(ROOT).as_posix(): found
        for path in pages
        if (found := re.findall(r"git clone (\S+) visuohaptic\b", path.read_text()))
    }
    assert set(clones) == {"README.md", "CONTRIBUTING.md"} <= set(WRITER["EDITS"])
    expected = FACTS.address or WRITER["BLANK_ADDRESS"]
    assert {address for found in clones.values() for address in found} == {expected}
    published = filled(**PUBLISHED)
    for name in ("README.md", "CONTRIBUTING.md", "SUPPORT.md"):
        assert WRITER["BLANK_ADDRESS"] not in published[name]
        assert PUBLISHED["address"] in published[name]
    blank = [name for name in clones if WRITER["BLANK_ADDRESS"] in (ROOT / name).read_text()]
    assert FACTS.address or set(blank) == set(clones)


@pytest.mark.parametrize("folder", PROJECTS)
def test_the_addresses_of_a_project_are_those_of_the_release(folder):
    def urls(text):
        return tomllib.loads(text)["project"]["urls"]

    name = (Path(folder) / "pyproject.toml").as_posix()
    assert bool(urls((ROOT / name).read_text())) == bool(FACTS.address)
    found = urls(filled(**PUBLISHED)[name])
    assert found["Repository"] == PUBLISHED["address"]
    assert all(address.startswith(PUBLISHED["address"]) for address in found.values())
    # Filled in twice is filled in once.
    edit = WRITER["set_urls"]
    facts = type(FACTS).model_validate({**FACTS.model_dump(), **PUBLISHED})
    once = edit(facts, (ROOT / name).read_text())
    assert edit(facts, once) == once
    assert edit(FACTS, once) == (ROOT / name).read_text()


@pytest.mark.parametrize("facts", [{}, PUBLISHED], ids=["blank", "published"])
def test_the_citation_names_version_date_and_authors(facts):
    cited = yaml.safe_load(filled(**facts)["CITATION.cff"])
    assert {"cff-version", "message", "title", "authors"} <= set(cited)
    assert (cited["version"], cited["date-released"]) == (FACTS.version, FACTS.date)
    if facts:
        assert [author["family-names"] for author in cited["authors"]] == ["Doe", "Roe"]
        assert cited["authors"][0]["orcid"] == "https://orcid.org/0000-0002-1825-0097"
        assert (cited["doi"], cited["repository-code"]) == (facts["doi"], facts["address"])


@pytest.mark.parametrize("facts", [{}, PUBLISHED], ids=["blank", "published"])
def test_the_record_for_zenodo_has_its_fields(facts):
    record = json.loads(filled(**facts)[".zenodo.json"])
    assert {"title", "upload_type", "description", "creators", "license"} <= set(record)
    assert set(record) <= ZENODO_FIELDS
    assert (record["upload_type"], record["access_right"]) == ("software", "open")
    assert (record["version"], record["publication_date"]) == (FACTS.version, str(FACTS.date))
    for creator in record["creators"]:
        assert {"name"} <= set(creator) <= {"name", "affiliation", "orcid"}
    assert not facts or record["creators"][1]["name"] == "Roe, Max"


@pytest.mark.parametrize("folder", [".", "packages/contourlets", "packages/meshreaders"])
def test_a_recipe_for_conda_asks_for_what_the_project_asks_for(folder):
    project = PROJECTS[folder]["project"]
    recipe = yaml.safe_load((ROOT / "recipes" / project["name"] / "recipe.yaml").read_text())
    assert recipe["context"]["version"] == FACTS.version
    assert project["requires-python"] == f">={recipe['context']['python_min']}"
    names = {"opencv-contrib-python-headless": "py-opencv", "mapbox-earcut": "mapbox_earcut"}
    wanted = {
        names.get(one.name, one.name): str(one.specifier)
        for one in map(Requirement, project["dependencies"])
        if one.name != project["name"]  # an extra of its own
    }
    asked = dict(line.split() for line in recipe["requirements"]["run"] if "python " not in line)
    assert asked == wanted


@pytest.mark.parametrize("form", ["bug", "question"])
def test_a_form_for_issues_has_fields_that_are_named(form):
    content = yaml.safe_load((ROOT / f".github/ISSUE_TEMPLATE/{form}.yml").read_text())
    assert {"name", "description", "body"} <= set(content)
    fields = [part for part in content["body"] if part["type"] != "markdown"]
    assert all(part["id"] and part["attributes"]["label"] for part in fields)
    assert len({part["id"] for part in fields}) == len(fields)
    text = str(content)
    assert "visuohaptic --version" in text
    if form == "bug":
        assert "make why" in text
        assert "results/records/" in text
