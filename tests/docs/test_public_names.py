"""README, the pages of docs/ and the examples use public names only, and one page lists these names."""

import ast
import json
import re
from importlib import import_module
from pathlib import Path

import pytest
from docs.shell_commands import blocks

ROOT = Path(__file__).parents[2]
PACKAGES = (
    "contourlets",
    "meshreaders",
    *(
        "visuohaptic",
        *(
            f"visuohaptic.{name}"
            for name in ("attention", "environment", "fixations", "recognition", "scene", "sensor")
        ),
    ),
)
LIST = ROOT / "docs/stable_interface.md"
PAGES = (ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md")))
NOTEBOOKS = sorted((ROOT / "docs").glob("*.ipynb"))
EXAMPLES = sorted((ROOT / "examples").glob("*.py"))


def codes(path):
    """Return the Python of a file, part by part."""
    if path.suffix == ".py":
        return [path.read_text()]
    if path.suffix == ".ipynb":
        cells = json.loads(path.read_text())["cells"]
        sources = ["".join(cell["source"]) for cell in cells if cell["cell_type"] == "code"]
        return [re.sub(r"^[%!].*$", "", source, flags=re.M) for source in sources]
    texts = [text for text in blocks(path, "text") if re.search(r"^(from|import) ", text, re.M)]
    return [*blocks(path, "python"), *texts]


def names_of(code):
    """Yield the module and the name of each name of the project that a code imports or takes from `vh`."""
    for node in ast.walk(ast.parse(code)):
        if isinstance(node, ast.ImportFrom) and node.module:
            yield from ((node.module, alias.name) for alias in node.names)
        elif isinstance(node, ast.Import):
            yield from ((alias.name, None) for alias in node.names)
        elif isinstance(node, ast.Attribute) and getattr(node.value, "id", None) == "vh":
            yield "visuohaptic", node.attr


def not_public(code):
    """List the names that a code imports and that are not public."""
    return [
        f"{module}.{name}" if name else module
        for module, name in names_of(code)
        if module.partition(".")[0] in {"visuohaptic", "contourlets", "meshreaders"}
        and not (
            module in PACKAGES
            and (
                name is None
                or f"{module}.{name}" in PACKAGES
                or name in (*import_module(module).__all__, "__version__")
            )
        )
    ]


@pytest.mark.parametrize(
    "path", [*PAGES, *NOTEBOOKS, *EXAMPLES], ids=lambda path: str(path.relative_to(ROOT))
)
def test_only_public_names_are_imported(path):
    assert [name for code in codes(path) for name in not_public(code)] == []


def test_the_page_of_names_lists_the_names_that_pages_use():
    used = {
        f"{module}.{name}"
        for path in (*PAGES, *NOTEBOOKS, *EXAMPLES)
        for code in codes(path)
        for module, name in names_of(code)
        if name and module in PACKAGES and f"{module}.{name}" not in PACKAGES
    }
    rows = re.findall(r"^\| `(visuohaptic[\w.]*)` \| (.*) \|$", LIST.read_text(), re.M)
    listed = {
        f"{module}.{name}" for module, names in rows for name in re.findall(r"`(\w+)`", names)
    }
    assert listed == used


@pytest.mark.parametrize(
    "code",
    [
        "from visuohaptic.geometry.raycasting import RayCaster",
        "import visuohaptic.parameters",
        "from visuohaptic import exploration",
        "from visuohaptic.recognition import splits",
        "import visuohaptic as vh\nvh.exploration",
    ],
)
def test_an_inner_name_would_be_noticed(code):
    assert len(not_public(code)) == 1


def test_every_page_and_example_is_read():
    assert sum(bool(codes(path)) for path in PAGES) > 5
    assert all(any(True for code in codes(path) for _ in names_of(code)) for path in EXAMPLES)
