"""Look at a 3D object, touch it where the eye would rest, and recognise it from touch alone.

``import visuohaptic as vh; vh.load("mug.obj").touch(viewpoints=16).recognise()``
"""

import importlib
import os

import lazy_loader

__version__ = "0.1.0"

# By name, not from the stub: what follows a package's stub to find which code a job runs would
# find all of the package behind this one.
__getattr__, __dir__, __all__ = lazy_loader.attach(
    __name__,
    submod_attrs={
        "attention.registry": ["Channel"],
        "errors": ["VisuohapticError"],
        "exploration.examples": ["example"],
        "exploration.exploring": ["Exploration", "Recognition", "TouchableObject", "load", "touch"],
        "exploration.file_frame": ["FileFrame"],
        "exploration.pose_files": ["read_poses", "write_poses"],
        "exploration.pressing": ["Pressed", "press"],
        "exploration.recognising": ["Recogniser", "read_recogniser"],
        "features.descriptors": ["Descriptor"],
        "fixations.probing": ["Strategy"],
        "parameters": ["read_parameters"],
        "plugins": ["register"],
        "recognition.classifiers": ["Classifier"],
        "recognition.evaluating": ["Evaluation", "evaluate"],
        "recognition.maps": ["Map"],
        "sensor.planner": ["Effect"],
    },
)

# Set by a process that starts this one: before anything else knows which names there are.
if os.environ.get("VISUOHAPTIC_PLUGINS"):
    importlib.import_module("visuohaptic.plugins").load_given()
