"""Example objects of the package. The packaged recognition model was not fitted on them."""

from __future__ import annotations

from pathlib import Path

from visuohaptic.base.errors import MeshError
from visuohaptic.exploration.exploring import TouchableObject, load

FOLDER = Path(__file__).with_name("examples")


def examples() -> dict[str, Path]:
    """Return the model file of each example. The name of an example is its class.

    Each example has the fewest triangles of its class in the catalogue, without the paper's twelve objects.
    """
    return {path.parent.name: path for path in sorted(FOLDER.glob("*/*/*.ply.gz"))}


def example(name: str) -> TouchableObject:
    """Load an object that comes with the package.

    Parameters
    ----------
    name : {"bottle", "car", "chair", "quadruped"}

    Returns
    -------
    TouchableObject

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
    files = examples()
    if name not in files:
        raise MeshError(f"{name!r} is no example; {', '.join(files)} are allowed.")
    return load(files[name])
