"""The number of objects on the page, and the number of faces of their models."""

OBJECTS_AT_MOST = 100
"""Objects on the page. 100 objects with 16 views each take 20 MB."""

_FACES_OF_ALL = 120_000
_FACES_AT_MOST = 4_000
_FACES_AT_LEAST = 1_200


def faces_of_model(objects: int) -> int:
    """Return the number of faces per model when `objects` objects share the page."""
    return min(max(_FACES_OF_ALL // max(objects, 1), _FACES_AT_LEAST), _FACES_AT_MOST)
