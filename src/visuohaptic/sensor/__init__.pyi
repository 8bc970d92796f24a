from .effects import EFFECTS as EFFECTS
from .effects import simulate as simulate
from .frames import column_axes as column_axes
from .frames import row_axes as row_axes
from .gallery import hard_probes as hard_probes
from .gallery import touch_gallery as touch_gallery
from .parameters import SensorParameters as SensorParameters
from .planner import Situation as Situation
from .random_fields import RandomFields as RandomFields
from .touching import Touches as Touches
from .touching import touch as touch

__all__ = [
    "EFFECTS",
    "RandomFields",
    "SensorParameters",
    "Situation",
    "Touches",
    "column_axes",
    "hard_probes",
    "row_axes",
    "simulate",
    "touch",
    "touch_gallery",
]
