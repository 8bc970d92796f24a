"""Open3D's compiled part is loaded alone, and once."""

import subprocess
import sys
from pathlib import Path

import pytest

from visuohaptic.geometry import compiled_open3d

pytestmark = pytest.mark.slow
SOURCE = Path(__file__).parents[2] / "src"


def test_open3d_is_loaded_without_its_web_viewer_and_once_for_who_imports_it_later():
    program = """
import sys
from visuohaptic.geometry.compiled_open3d import open3d as compiled
RaycastingScene = compiled.t.geometry.RaycastingScene
assert not {"dash", "flask"} & set(sys.modules)
import open3d
assert open3d.t.geometry.RaycastingScene is RaycastingScene
assert compiled is open3d.pybind
"""
    subprocess.run([sys.executable, "-c", program], check=True, env={"PYTHONPATH": str(SOURCE)})


def test_open3d_is_imported_whole_where_its_compiled_part_is_not_where_it_was(monkeypatch):
    import open3d

    monkeypatch.setattr(compiled_open3d, "_compiled_open3d", lambda: None)
    assert compiled_open3d._load_open3d() is open3d
