from .attention.registry import Channel as Channel
from .base.errors import VisuohapticError as VisuohapticError
from .evaluation.evaluating import Evaluation as Evaluation
from .evaluation.evaluating import evaluate as evaluate
from .exploration.examples import example as example
from .exploration.exploring import Exploration as Exploration
from .exploration.exploring import Recognition as Recognition
from .exploration.exploring import TouchableObject as TouchableObject
from .exploration.exploring import load as load
from .exploration.exploring import touch as touch
from .exploration.file_frame import FileFrame as FileFrame
from .exploration.pose_files import read_poses as read_poses
from .exploration.pose_files import write_poses as write_poses
from .exploration.pressing import Pressed as Pressed
from .exploration.pressing import press as press
from .exploration.recognising import Recogniser as Recogniser
from .exploration.recognising import read_recogniser as read_recogniser
from .features.descriptors import Descriptor as Descriptor
from .fixations.probing import Strategy as Strategy
from .io.plugins import register as register
from .parameters import read_parameters as read_parameters
from .recognition.classifiers import Classifier as Classifier
from .recognition.maps import Map as Map
from .sensor.effect_pipeline import Effect as Effect

__version__: str
