"""How many objects share the page, and how thin that makes their models."""

OBJECTS_AT_MOST = 100
"""So many objects take 20 MB of the page with 16 views each."""

_FACES_OF_ALL = 120_000
_FACES_AT_MOST = 4_000
_FACES_AT_LEAST = 1_200


def faces_of_model(objects: int) -> int:
    """Give the faces that each model may have where so many objects share the page."""
    return min(max(_FACES_OF_ALL // max(objects, 1), _FACES_AT_LEAST), _FACES_AT_MOST)
