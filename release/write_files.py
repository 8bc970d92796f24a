"""Write the facts of a release (facts.yaml) to every file that holds them: `make release`."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Iterator, Sequence
from datetime import date
from functools import partial
from pathlib import Path
from typing import Any

import yaml
from pydantic import BaseModel, ConfigDict, Field

ROOT = Path(__file__).parents[1]
BLANK_ADDRESS = "<address>"
BLANK_CONTACT = "<contact>"
NOBODY = "The visuohaptic authors"
TITLE = "visuohaptic"
ABSTRACT = (
    "Look at a 3D object, touch it where the eye would fixate, and recognise it from touch alone: "
    "a Python library and a workflow that rebuild a visuo-haptic experiment on object recognition."
)
KEYWORDS = (
    "haptics",
    "object recognition",
    "reproducibility",
    "tactile sensing",
    "visual attention",
)
PAPER_TITLE = (
    "A Visuo-Haptic Framework for Object Recognition Inspired from Human Tactile Perception"
)
PAPER_ADDRESS = "https://www.mdpi.com/2504-3900/4/1/47"
TO_FILL = "<!-- to be filled by the persons who submit: {} -->"


class Author(BaseModel):
    """A person who wrote the software."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    family_names: str = Field(alias="family-names")
    given_names: str = Field(alias="given-names")
    orcid: str | None = Field(default=None, pattern=r"^\d{4}-\d{4}-\d{4}-\d{3}[\dX]$")
    affiliation: str | None = None


class Facts(BaseModel):
    """Version and date of a release, where it is published, and by whom."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    version: str = Field(pattern=r"^\d+\.\d+\.\d+$")
    date: date
    address: str | None = Field(default=None, pattern=r"^https://[^\s<>]+[^\s<>/]$")
    doi: str | None = Field(default=None, pattern=r"^10\.\d{4,9}/\S+$")
    contact: str | None = None
    authors: tuple[Author, ...] = ()


def read_facts() -> Facts:
    """Read facts.yaml."""
    return Facts.model_validate(yaml.safe_load((ROOT / "release/facts.yaml").read_text("utf-8")))


def release_files(facts: Facts) -> Iterator[tuple[Path, str]]:
    """Compute the content of each file that holds a fact of the release."""
    yield ROOT / "CITATION.cff", citation(facts)
    yield ROOT / ".zenodo.json", zenodo_record(facts)
    for name, edits in EDITS.items():
        text = (ROOT / name).read_text(encoding="utf-8")
        for edit in edits:
            edited = edit(facts, text)
            if edited is None:
                raise SystemExit(f"{name} has no place for the facts of {_name_of(edit)}.")
            text = edited
        yield ROOT / name, text


def citation(facts: Facts) -> str:
    """Return CITATION.cff, for readers and for the citation button of code hosts."""
    content: dict[str, Any] = {
        "cff-version": "1.2.0",
        "message": "If you use this software, please cite it and the paper that it rebuilds.",
        "title": TITLE,
        "abstract": ABSTRACT,
        "type": "software",
        "version": facts.version,
        "date-released": facts.date,
        "license": "MIT",
        "keywords": list(KEYWORDS),
        "authors": [_cited(author) for author in facts.authors] or [{"name": NOBODY}],
    }
    if facts.doi:
        content["doi"] = facts.doi
    if facts.address:
        content["repository-code"] = facts.address
    content["references"] = [
        {
            "type": "article",
            "scope": "The experiment that this software rebuilds",
            "title": PAPER_TITLE,
            "authors": [
                {"family-names": "Rouhafzay", "given-names": "Ghazal"},
                {"family-names": "Cretu", "given-names": "Ana-Maria"},
            ],
            "journal": "Proceedings",
            "volume": 4,
            "issue": 1,
            "start": 47,
            "year": 2018,
            "url": PAPER_ADDRESS,
        }
    ]
    head = "# `make release` writes this file from release/facts.yaml; authors and DOI are filled in there.\n"
    return head + yaml.safe_dump(content, sort_keys=False, allow_unicode=True, width=100)


def _cited(author: Author) -> dict[str, str]:
    fields = {"family-names": author.family_names, "given-names": author.given_names}
    if author.affiliation:
        fields["affiliation"] = author.affiliation
    if author.orcid:
        fields["orcid"] = f"https://orcid.org/{author.orcid}"
    return fields


def zenodo_record(facts: Facts) -> str:
    """Return .zenodo.json, which Zenodo reads when a release is archived."""
    creators = [
        {
            "name": f"{author.family_names}, {author.given_names}",
            **({"affiliation": author.affiliation} if author.affiliation else {}),
            **({"orcid": author.orcid} if author.orcid else {}),
        }
        for author in facts.authors
    ]
    related = [
        {"identifier": PAPER_ADDRESS, "relation": "references", "scheme": "url"},
        *(
            [{"identifier": facts.address, "relation": "isSupplementTo", "scheme": "url"}]
            if facts.address
            else []
        ),
    ]
    content = {
        "title": f"{TITLE} {facts.version}",
        "upload_type": "software",
        "description": ABSTRACT,
        "version": facts.version,
        "publication_date": facts.date.isoformat(),
        "creators": creators or [{"name": NOBODY}],
        "access_right": "open",
        "license": "MIT",
        "language": "eng",
        "keywords": list(KEYWORDS),
        "related_identifiers": related,
    }
    return json.dumps(content, indent=2, ensure_ascii=False) + "\n"


Edit = Callable[[Facts, str], str | None]
"""Returns a text with a fact filled in, or nothing where the text has no place for the fact."""


def set_version(pattern: str, facts: Facts, text: str) -> str | None:
    """Set the version behind a pattern such as ``__version__ = ``."""
    return _replace(rf'^({pattern})"?\d+\.\d+\.\d+"?$', rf'\g<1>"{facts.version}"', text)


def set_clone_address(facts: Facts, text: str) -> str | None:
    """Set the address in each ``git clone ADDRESS visuohaptic``."""
    address = facts.address or BLANK_ADDRESS
    return _replace(r"(git clone )\S+( visuohaptic\b)", rf"\g<1>{address}\g<2>", text)


def set_issue_address(facts: Facts, text: str) -> str | None:
    """Set the address of the issue tracker, ``ADDRESS/issues``."""
    address = facts.address or BLANK_ADDRESS
    return _replace(r"(?:<address>|https://[^\s`]+)(/issues\b)", rf"{address}\g<1>", text)


def set_contact(facts: Facts, text: str) -> str | None:
    """Set who reads reports on conduct."""
    return _replace(r"(write to `)[^`]+(`)", rf"\g<1>{facts.contact or BLANK_CONTACT}\g<2>", text)


def set_urls(facts: Facts, text: str) -> str | None:
    """Set the table of addresses of a pyproject.toml; empty while the address is not known."""
    lines = ""
    if facts.address:
        changes = f"{facts.address}/blob/HEAD/CHANGELOG.md"
        lines = f'Repository = "{facts.address}"\nIssues = "{facts.address}/issues"\nChangelog = "{changes}"\n'
    return _replace(r"^(\[project\.urls\].*\n)(?:[A-Z]\w* = .*\n)*", rf"\g<1>{lines}", text)


def set_recipe_address(facts: Facts, text: str) -> str | None:
    """Set the addresses in a recipe of conda-forge; commented out while the address is not known."""
    mark, address = ("", facts.address) if facts.address else ("# ", BLANK_ADDRESS)
    return _replace(r"^  (?:# )?((?:homepage|repository): )\S+$", rf"  {mark}\g<1>{address}", text)


def set_paper_authors(facts: Facts, text: str) -> str | None:
    """Set authors, affiliations and date in the header of the paper."""
    named = [author.affiliation for author in facts.authors if author.affiliation]
    affiliations = list(dict.fromkeys(named))
    authors: Sequence[dict[str, object]] = [
        {
            "name": f"{author.given_names} {author.family_names}",
            **({"orcid": author.orcid} if author.orcid else {}),
            **(
                {"affiliation": str(affiliations.index(author.affiliation) + 1)}
                if author.affiliation
                else {}
            ),
        }
        for author in facts.authors
    ] or [{"name": TO_FILL.format("authors, in release/facts.yaml"), "affiliation": "1"}]
    header = {
        "authors": authors,
        "affiliations": [
            {"name": name, "index": index}
            for index, name in enumerate(
                affiliations or [TO_FILL.format("affiliations, in release/facts.yaml")], 1
            )
        ],
        "date": f"{facts.date.day} {facts.date:%B %Y}",
    }
    dumped = yaml.safe_dump(header, sort_keys=False, allow_unicode=True, width=1000)
    return _replace(r"^authors:\n(?:.*\n)*?(?=bibliography:)", dumped.replace("\\", r"\\"), text)


def _replace(pattern: str, replacement: str, text: str) -> str | None:
    changed, found = re.subn(pattern, replacement, text, flags=re.M)
    return changed if found else None


def _name_of(edit: Edit) -> str:
    function = edit.func if isinstance(edit, partial) else edit
    return str(getattr(function, "__name__", function))


_MODULE = partial(set_version, "__version__ = ")
_RECIPE: tuple[Edit, ...] = (partial(set_version, "  version: "), set_recipe_address)
EDITS: dict[str, tuple[Edit, ...]] = {
    "src/visuohaptic/__init__.py": (_MODULE,),
    "packages/contourlets/src/contourlets/__init__.py": (_MODULE,),
    "packages/meshreaders/src/meshreaders/__init__.py": (_MODULE,),
    "pyproject.toml": (set_urls,),
    "packages/contourlets/pyproject.toml": (set_urls,),
    "packages/meshreaders/pyproject.toml": (set_urls,),
    "src/visuohaptic/attention/pyproject.toml": (partial(set_version, "version = "), set_urls),
    "recipes/visuohaptic/recipe.yaml": _RECIPE,
    "recipes/contourlets/recipe.yaml": _RECIPE,
    "recipes/meshreaders/recipe.yaml": _RECIPE,
    "README.md": (set_clone_address,),
    "CONTRIBUTING.md": (set_clone_address,),
    "SUPPORT.md": (set_issue_address,),
    "CODE_OF_CONDUCT.md": (set_contact,),
    "paper/paper.md": (set_paper_authors,),
}
"""What `make release` edits in each file."""


if __name__ == "__main__":
    for path, text in release_files(read_facts()):
        path.write_text(text, encoding="utf-8")
