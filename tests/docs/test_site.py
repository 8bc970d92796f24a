"""The documentation site: its navigation reaches every page, and a link that leads nowhere ends the build."""

import os
import re
import runpy
import shutil
import subprocess
import sys
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

import pytest
import yaml
from source_folders import PYTHONPATH

ROOT = Path(__file__).parents[2]
ADDRESS = "https://forge.example/someone/visuohaptic"
NEEDED = ("myst_parser", "pydata_sphinx_theme", "sphinxcontrib.mermaid")


@pytest.fixture
def site(monkeypatch):
    monkeypatch.syspath_prepend(ROOT / "docs")
    return runpy.run_path(str(ROOT / "docs" / "make_site.py"))


@pytest.mark.parametrize(
    ("link", "expected"),
    [
        ("[a](tour.md#touch-an-object)", "[a](/docs/tour.md#touch-an-object)"),
        ("[a](../README.md)", "[a](/index.md)"),
        ("[a](../packages/contourlets)", "[a](/packages/contourlets/index.md)"),
        ("[a](../params.yaml)", f"[a]({ADDRESS}/blob/HEAD/params.yaml)"),
        ("[a](../src)", f"[a]({ADDRESS}/tree/HEAD/src)"),
        ("![a](pictures/leads.png)", "![a](pictures/leads.png)"),
        ("[a](none.md)", "[a](none.md)"),
        ("[a](https://example.org/b.md)", "[a](https://example.org/b.md)"),
        ("[a](#here)", "[a](#here)"),
    ],
)
def test_links_lead_to_pages_of_the_site_or_to_the_repository(site, link, expected):
    assert site["relink"](link, "docs/sensor.md", site["site_pages"](), ADDRESS) == expected


def test_without_an_address_no_link_leads_to_files_of_the_repository(site):
    text = "[params.yaml](../params.yaml), [a](tour.md), [b](none.md)"
    relinked = site["relink"](text, "docs/sensor.md", site["site_pages"](), None)
    assert relinked == "params.yaml, [a](/docs/tour.md), [b](none.md)"


@pytest.mark.parametrize(
    ("link", "expected"),
    [
        ("[sweeps.md](/docs/sweeps.md)", "[](/docs/sweeps.md)"),
        ("[docs/sweeps.md](/docs/sweeps.md#limits)", "[](/docs/sweeps.md#limits)"),
        ("[studies/turned](/studies/turned/index.md)", "[](/studies/turned/index.md)"),
        ("[method](/docs/method.md)", "[method](/docs/method.md)"),
        ("[a page.md](/docs/a.md)", "[a page.md](/docs/a.md)"),
        ("[src/a.md](https://example.org/a.md)", "[src/a.md](https://example.org/a.md)"),
    ],
)
def test_links_that_show_a_path_get_the_title_of_the_page_or_section(site, link, expected):
    assert site["titled"](link) == expected


def test_the_sections_of_the_index_list_every_page_of_docs_and_studies(site):
    text = (ROOT / "docs" / "README.md").read_text()
    listed = {
        site["target_of"]("docs/README.md", link["target"]) for link in site["LINK"].finditer(text)
    }
    listed |= {f"{path}/README.md" for path in listed if (ROOT / path).is_dir()}
    # A README lists the pages of its folder.
    below = {page for page in site["site_pages"]() if page.startswith("packages/meshreaders/docs/")}
    assert site["site_pages"]().keys() - listed - below == {"docs/README.md"}


@pytest.mark.parametrize(
    ("urls", "address"),
    [
        ("", None),
        ('[project.urls]\nHomepage = "https://a.org"\n', "https://a.org"),
        (
            '[project.urls]\nHomepage = "https://a.org"\nRepository = "https://b.org/c.git"\n',
            "https://b.org/c",
        ),
    ],
)
def test_the_address_of_the_repository_is_read_from_the_project(site, tmp_path, urls, address):
    (tmp_path / "pyproject.toml").write_text(f'[project]\nname = "a"\n{urls}')
    read = site["repository_address"]
    read.__globals__["ROOT"] = tmp_path
    assert read() == address


@pytest.fixture
def made_pages(site, monkeypatch):
    monkeypatch.syspath_prepend(ROOT / "docs" / "site")
    return runpy.run_path(str(ROOT / "docs" / "site" / "made_pages.py"))


def test_the_tables_of_parameters_name_defaults_and_bounds(made_pages):
    text = made_pages["parameters_page"]()
    assert "| `sensor.resolution` | `32` | ≥ 2, ≤ 256 |" in text
    assert "`scene.cover_modulus_pa`" in text
    assert "0.5" in next(line for line in text.splitlines() if "`scene.hysteresis`" in line)


def test_what_publishes_the_site_runs_targets_that_there_are():
    text = (ROOT / ".github" / "workflows" / "site.yml").read_text()
    steps = yaml.safe_load(text)["jobs"]["build"]["steps"]
    targets = [step["run"].split()[1] for step in steps if "make" in step.get("run", "")[:4]]
    assert targets == ["report", "site"]
    makefile = (ROOT / "Makefile").read_text()
    assert all(re.search(rf"^{target}:", makefile, re.M) for target in targets)
    [path] = [step["with"]["path"] for step in steps if "path" in step.get("with", {})]
    assert path == "build/site"


class Links(HTMLParser):
    def __init__(self):
        super().__init__()
        self.targets = []

    def handle_starttag(self, tag, attributes):
        names = {"a": "href", "img": "src", "iframe": "src"}
        if (value := dict(attributes).get(names.get(tag))) is not None:
            self.targets.append(value)


@pytest.fixture
def settings():
    for name in NEEDED:
        pytest.importorskip(name, reason="the extra docs is not installed")


def test_the_page_of_the_report_shows_the_run_that_is_there(site, made_pages, tmp_path):
    report = tmp_path / "report.html"
    shown = made_pages["report_page"](report, tmp_path / "none")
    assert "No run had been made" in shown
    report.write_text("<p>a run</p>")
    shown = made_pages["report_page"](report, tmp_path / "extra")
    assert 'src="run.html"' in shown
    assert (tmp_path / "extra" / "run.html").read_text() == "<p>a run</p>"


@pytest.mark.slow
@pytest.mark.long
def test_the_site_builds_without_a_warning_and_no_link_of_it_is_broken(settings, tmp_path):
    # In a process of its own: the gallery registers the examples.
    built = subprocess.run(
        [sys.executable, ROOT / "docs" / "make_site.py", tmp_path],
        cwd=ROOT, env={**os.environ, "PYTHONPATH": PYTHONPATH},
        check=False, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
    )  # fmt: skip
    assert built.returncode == 0, built.stdout
    made = tmp_path / "site"
    assert (made / ".nojekyll").is_file()
    pages = sorted(made.rglob("*.html"))
    assert len(pages) > 100
    assert len(list((made / "_images").glob("*.png"))) >= 7
    broken = []
    for page in pages:
        links = Links()
        links.feed(page.read_text(encoding="utf-8"))
        for target in links.targets:
            path = unquote(urlsplit(target).path)
            if not urlsplit(target).scheme and path and not (page.parent / path).exists():
                broken.append((page.relative_to(made).as_posix(), target))
    assert broken == []
    names = re.findall(
        r"import (\w+) as", (ROOT / "src/visuohaptic/__init__.pyi").read_text(), re.M
    )
    reference = made / "reference" / "names"
    assert {f"visuohaptic.{name}.html" for name in names} <= {
        path.name for path in reference.iterdir()
    }


@pytest.mark.slow
@pytest.mark.long
@pytest.mark.parametrize(
    "text", ["[a](none.md)", "[a](other.md#none)", "![a](none.png)", "```{toctree}\nnone\n```"]
)
def test_a_link_that_leads_nowhere_ends_the_build(site, settings, tmp_path, text):
    source = tmp_path / "source"
    (source / "extra").mkdir(parents=True)
    (source / "other.md").write_text("# Other\n")
    toctree = "\n```{toctree}\nother\n```\n"
    (source / "index.md").write_text(f"# A page\n\n[other](other.md)\n{toctree}")
    assert site["build"](source, tmp_path / "site") == 0
    (source / "index.md").write_text(f"# A page\n\n{text}\n{toctree}")
    shutil.rmtree(tmp_path / "site")
    assert site["build"](source, tmp_path / "again") != 0
