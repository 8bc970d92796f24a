"""What holds of the refusal of any hostile file."""

import time
import tracemalloc

import pytest

from visuohaptic.errors import MeshError
from visuohaptic.meshes.catalogue import Model
from visuohaptic.meshes.parameters import MeshParameters
from visuohaptic.meshes.preparing import prepare_object


def check_refused_at_once(path, says):
    """Prepare a model's file: a sentence names it, and neither time nor memory is spent."""
    tracemalloc.start()
    started = time.process_time()
    with pytest.raises(MeshError, match=says) as caught:
        prepare_object(Model("a", "b"), path, MeshParameters(largest_megabytes=50))
    seconds, (_, peak) = time.process_time() - started, tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert str(path) in str(caught.value)
    assert len(str(caught.value)) < 500
    assert seconds < 5
    assert peak < 100e6
