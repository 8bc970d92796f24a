from .errors import VisuohapticError as VisuohapticError
from .exploration import Exploration as Exploration
from .exploration import Recogniser as Recogniser
from .exploration import Recognition as Recognition
from .exploration import TouchableObject as TouchableObject
from .exploration import load as load
from .exploration import read_parameters as read_parameters
from .exploration import read_recogniser as read_recogniser

__all__ = [
    "Exploration",
    "Recogniser",
    "Recognition",
    "TouchableObject",
    "VisuohapticError",
    "load",
    "read_parameters",
    "read_recogniser",
]
__version__: str
