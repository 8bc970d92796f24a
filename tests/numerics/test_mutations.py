"""Expressions of the library that are broken one at a time: the checks named with each notice it."""

import importlib
import inspect
import textwrap
from dataclasses import dataclass
from functools import reduce

import pytest
from numerics.checks import CHECKS, holds

from visuohaptic.parameters import ExperimentParameters

SEED = ExperimentParameters().seed


@dataclass(frozen=True)
class Mutation:
    """A broken expression: what it stands for, the function that holds it, and the checks that notice."""

    change: str
    function: str
    expression: str
    broken: str
    checks: tuple[str, ...]


MUTATIONS = (
    Mutation("a sign in the ladder", "contourlets.filters:ladder_steps",
             "LadderStep(1, -root, -1.0,", "LadderStep(1, -root, 1.0,", ("bands",)),
    Mutation("no scaling before squares", "contourlets.images:exponents",
             "np.where(comfortable, 0, exponent)", "np.where(comfortable, 0, 0)", ("images_in_other_units",)),
    Mutation("sensing points half a cell aside", "visuohaptic.geometry.layouts:sensing_offsets",
             "np.arange(count) + 1 - count", "np.arange(count) - count", ("pressed_spheres",)),
    Mutation("a tangent frame that is left-handed", "visuohaptic.sensor.frames:row_axes",
             "np.cross(columns, normals)", "np.cross(normals, columns)", ("frames",)),
    Mutation("a missing clamp of the sensor's size", "visuohaptic.sensor.adaptive_size:admissible_sizes",
             "np.clip(2 * half_sizes * (1 - _STAND_CLEAR), smallest, largest)",
             "2 * half_sizes * (1 - _STAND_CLEAR)", ("wild_surfaces",)),
    Mutation("float32 in the distances of the re-cast", "visuohaptic.geometry.raycasting:_put",
             "= new_hits.distance", "= new_hits.distance.astype(np.float32)", ("vertices_and_edges", "random_triangles")),
    Mutation("distances computed in float32, as Embree does", "visuohaptic.geometry.raycasting:RayCaster._cast",
             "np.divide(planes[3] - dot(planes.T, origins), along, out=distance, where=met)",
             "np.divide(np.float32(planes[3]) - np.float32(dot(planes.T, origins)), np.float32(along), "
             "out=distance, where=met)", ("random_triangles",)),
    Mutation("no slack at vertices in the re-cast", "visuohaptic.geometry.raycasting:RayCaster._first_of_candidates",
             "(sides >= -slack).all(axis=2) | (sides <= slack)", "(sides > slack).all(axis=2) | (sides < -slack)",
             ("vertices_and_edges", "leaks")),
    Mutation("half a focus of inhibition", "visuohaptic.attention.scanpath:_winners",
             "(distance <= 1.0)", "(distance <= 0.5)", ("noisy_views",)),
    Mutation("a reduction that keeps every other pixel", "visuohaptic.attention.pyramid:reduce",
             "cv2.resize(blur(plane, border), (half, half), interpolation=cv2.INTER_AREA)",
             "np.ascontiguousarray(blur(plane, border)[::2, ::2][:half, :half])", ("pyramids",)),
    Mutation("brightness of denormal numbers", "visuohaptic.attention.channels:prepare_view",
             "peak >= DARKEST", "peak > 0.0", ("hard_views",)),
    Mutation("a dropped regularisation", "visuohaptic.recognition.quadratic_discriminant:regularised_covariance",
             "floor * np.eye", "0.0 * np.eye", ("classifiers",)),
    Mutation("skewness of rounding noise", "visuohaptic.recognition.sequence_features:summarise_signals",
             "np.sqrt(second) <= CONSTANT_TOLERANCE * root_mean_square", "second <= 0", ("sequence_moments",)),
    Mutation("only some failures of a reader are caught", "meshreaders.reading:_read_content",
             "except Exception as", "except ValueError as", ("broken_files",)),
)  # fmt: skip


def broken_code(function, expression, broken):
    """Compile a function with one expression exchanged, which it has to hold once."""
    source = textwrap.dedent(inspect.getsource(function))
    assert source.count(expression) == 1, f"{function.__qualname__} does not hold {expression} once"
    made = {}
    exec(source.replace(expression, broken), function.__globals__, made)  # noqa: S102
    return inspect.unwrap(made[function.__name__]).__code__


@pytest.mark.slow
@pytest.mark.parametrize("mutation", MUTATIONS, ids=lambda mutation: mutation.change)
def test_a_broken_expression_is_noticed(monkeypatch, no_caches, mutation):
    module, _, name = mutation.function.partition(":")
    found = reduce(getattr, name.split("."), importlib.import_module(module))
    function = inspect.unwrap(found)
    # The code is exchanged, so that whoever has imported the function runs the broken one, too.
    code = broken_code(function, mutation.expression, mutation.broken)
    monkeypatch.setattr(function, "__code__", code)
    for name in mutation.checks:
        assert not holds(CHECKS[name], SEED, CHECKS[name].draws), name
