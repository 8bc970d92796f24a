from .errors import VisuohapticError as VisuohapticError
from .exploration.exploring import Exploration as Exploration
from .exploration.exploring import TouchableObject as TouchableObject
from .exploration.exploring import load as load
from .exploration.exploring import touch as touch
from .exploration.pressing import Pressed as Pressed
from .exploration.pressing import press as press
from .exploration.recognising import Recogniser as Recogniser
from .exploration.recognising import Recognition as Recognition
from .exploration.recognising import read_recogniser as read_recogniser
from .parameters import read_parameters as read_parameters

__all__ = [
    "Exploration",
    "Pressed",
    "Recogniser",
    "Recognition",
    "TouchableObject",
    "VisuohapticError",
    "load",
    "press",
    "read_parameters",
    "read_recogniser",
    "touch",
]
__version__: str
