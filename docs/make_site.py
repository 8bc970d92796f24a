"""Build the documentation site in build/site from the repository's pages: `make site`.

The pages lie where a forge shows them. This script copies them into one folder, in which each README is
the index of its folder, turns links to code into links to the repository, and adds the pages that come
from code (docs/site/made_pages.py). docs/README.md is the navigation: each of its sections becomes a page
with the section's table, and the pages that the table links to become the entries below that page.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import tomllib
from collections.abc import Iterable, Mapping
from functools import partial
from pathlib import Path

DOCS = Path(__file__).parent
ROOT = DOCS.parent
SETTINGS = DOCS / "site"
BUILD = ROOT / "build"
REPORT = ROOT / "reports" / "report.html"
FIRST, NAVIGATION = "README.md", "docs/README.md"
# All pages of these folders are on the site, and of others the pages that docs/README.md lists.
FOLDERS = ("docs/", "packages/", "studies/")
PICTURES = ("docs/*.png", "packages/*.png", "studies/*.png")
RULE = re.compile(r"^\|(---\|)+\n", re.M)
WORD = r"[\w./-]+"
PATH = r"[\w/-]+\.md|[\w-]+/[\w/-]+"
LINK = re.compile(r"(?P<start>!?\[[^\]]*\]\()(?P<target>[^)\s#:]+)(?P<anchor>#[^)\s]*)?\)")


def repository_address() -> str | None:
    """Return the address of the repository, from `project.urls` of pyproject.toml; None if there is none."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    addresses = {name.lower(): str(address) for name, address in project.get("urls", {}).items()}
    names = [name for name in ("repository", "source", "homepage") if name in addresses]
    return addresses[names[0]].rstrip("/").removesuffix(".git") if names else None


def listed_files(*patterns: str) -> list[str]:
    """List files of the clone that git tracks or would track, relative to its root."""
    command = ["git", "ls-files", "--cached", "--others", "--exclude-standard", "--", *patterns]
    listed = subprocess.run(command, cwd=ROOT, check=True, capture_output=True, text=True)
    return sorted(name for name in set(listed.stdout.splitlines()) if (ROOT / name).is_file())


def site_pages() -> dict[str, str]:
    """Map each page of the repository to its name on the site: a README is the index of its folder."""
    links = LINK.finditer((ROOT / NAVIGATION).read_text(encoding="utf-8"))
    listed = {FIRST, *(target_of(NAVIGATION, link["target"]) for link in links)}
    names = [name for name in listed_files("*.md") if name.startswith(FOLDERS) or name in listed]
    return {name: re.sub(r"README\.md$", "index.md", name) for name in names}


def target_of(page: str, target: str) -> str:
    """Return the path that a link of a page leads to, relative to the root of the clone."""
    return os.path.normpath(Path(page).parent / target)


def relink(text: str, page: str, pages: Mapping[str, str], address: str | None) -> str:
    """Turn the links of a page into links to pages of the site, or to files of the repository.

    Without an address of the repository, only the text of a link to a file stays. A link to a file that the clone lacks
    stays, so that the build ends with a warning about the link.
    """

    def replaced(found: re.Match[str]) -> str:
        path, target = target_of(page, found["target"]), found["target"]
        if (ROOT / path).is_dir() and f"{path}/README.md" in pages:
            path = f"{path}/README.md"
        if path in pages:
            target = f"/{pages[path]}"
        elif (ROOT / path).exists() and not found["start"].startswith("!"):
            if address is None:
                return found["start"].removeprefix("[").removesuffix("](")
            target = f"{address}/{'tree' if (ROOT / path).is_dir() else 'blob'}/HEAD/{path}"
        return f"{found['start']}{target}{found['anchor'] or ''})"

    return LINK.sub(replaced, text)


def titled(text: str, shown: str = PATH) -> str:
    """Empty the text of links that matches `shown`, so that Sphinx shows the title of the page or section."""
    return re.sub(rf"\[(?:{shown})\](?=\(/[^)]+\.md(?:#[^)]+)?\))", "[]", text)


def table_of_contents(names: Iterable[str]) -> str:
    """Return a table of contents that only the navigation shows."""
    entries = "\n".join(f"/{name}" for name in names)
    return f"\n```{{toctree}}\n:hidden:\n\n{entries}\n```\n" if entries else ""


def write(source: Path, name: str, text: str) -> None:
    """Write a page of the site's source."""
    path = source / name
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, encoding="utf-8")


def sections() -> dict[str, str]:
    """Return the text of each section of docs/README.md, by its heading."""
    _, *parts = re.split(r"^## (.+)\n", (ROOT / NAVIGATION).read_text(encoding="utf-8"), flags=re.M)
    return dict(zip(parts[::2], parts[1::2], strict=True))


def collect(source: Path, made: Mapping[str, Mapping[str, str]], address: str | None) -> None:
    """Copy all pages and pictures to a folder, with the navigation that docs/README.md lays down.

    Parameters
    ----------
    source : path
        Folder of the site's source.
    made : mapping
        Of each section, the rows of pages made from code: page to what its reader wants to know.
    address : str or None
        Address of the repository.
    """
    pages, headed, listed = site_pages(), [], {FIRST, NAVIGATION}
    for heading, text in sections().items():
        links = dict.fromkeys(target_of(NAVIGATION, link["target"]) for link in LINK.finditer(text))
        files = [f"{path}/README.md" if (ROOT / path).is_dir() else path for path in links]
        entries = [path for path in files if path in pages and path not in listed]
        listed |= set(entries)
        of_code = made.get(heading, {})
        rows = "".join(f"| {asked} | [](/{name}.md) |\n" for name, asked in of_code.items())
        linked = relink(text, NAVIGATION, pages, address)
        body = RULE.sub(rf"\g<0>{rows}", titled(linked, WORD), count=1)
        names = [*(f"{name}.md" for name in of_code), *(pages[path] for path in entries)]
        headed.append(f"docs/{re.sub(r'[^a-z]+', '_', heading.lower())}.md")
        write(
            source,
            headed[-1],
            f"# {heading}\n\n{body.strip()}\n{table_of_contents(names)}",
        )
    # A page that no section lists stands below the README of its folder.
    unlisted = [path for path in pages if path not in listed]
    for path, name in pages.items():
        text = titled(relink((ROOT / path).read_text(encoding="utf-8"), path, pages, address))
        below = [pages[one] for one in unlisted if Path(one).parent == Path(path).parent]
        if path == FIRST:
            text += table_of_contents(headed)
        elif path == NAVIGATION:
            text = f"---\norphan: true\n---\n{text}"
        elif path.endswith("README.md"):
            text += table_of_contents(below)
        write(source, name, text)
    for name in listed_files(*PICTURES):
        (source / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / name, source / name)


def build(source: Path, site: Path) -> int:
    """Run Sphinx; return 0, or another status if it warned of anything."""
    from sphinx.cmd.build import main as run_sphinx

    options = ["-W", "--keep-going", "-q", "-c", str(SETTINGS), "-d", f"{site}_doctrees"]
    extra = ["-D", f"html_extra_path={source / 'extra'}"]
    return run_sphinx([*options, *extra, str(source), str(site)])


def main(folder: Path) -> int:
    """Build the site in a folder; return the status of Sphinx."""
    sys.path.insert(0, str(SETTINGS))
    from made_pages import MADE, make_pages

    source, site = folder / "site_source", folder / "site"
    for one in (source, site):
        shutil.rmtree(one, ignore_errors=True)
    address = repository_address()
    collect(source, MADE, address)
    make_pages(partial(write, source), source, REPORT, address)
    status = build(source, site)
    if status == 0:
        (site / ".nojekyll").touch()  # GitHub Pages leaves out folders such as _static otherwise
        print(f"The site is at {site / 'index.html'}.")
    return status


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]) if sys.argv[1:] else BUILD))
