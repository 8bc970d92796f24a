from .places import ProbingLocations as ProbingLocations
from .strategies.visible import draw_visible as draw_visible
