"""Objects that come with the package, none of which its model has learnt: a start without a mesh of one's own."""

from __future__ import annotations

from pathlib import Path

from visuohaptic.base.errors import MeshError
from visuohaptic.exploration.exploring import TouchableObject, load

FOLDER = Path(__file__).with_name("examples")


def examples() -> dict[str, Path]:
    """Give the model of each example by its name, which is its class.

    It is the one with the fewest triangles of its class in the catalogue beside the paper's twelve.
    """
    return {path.parent.name: path for path in sorted(FOLDER.glob("*/*/*.ply.gz"))}


def example(name: str) -> TouchableObject:
    """Load an object that comes with the package.

    Parameters
    ----------
    name : {"bottle", "car", "chair", "quadruped"}
        Which one.

    Returns
    -------
    TouchableObject
        The object.

    Raises
    ------
    MeshError
        If there is no such example.

    Examples
    --------
    >>> import visuohaptic as vh
    >>> vh.example("chair")
    <TouchableObject chair/kl_dining-chair: 1,380 triangles>
    """
    found = examples()
    if name not in found:
        raise MeshError(f"{name!r} is no example; {', '.join(found)} are allowed.")
    return load(found[name])
