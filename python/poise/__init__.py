"""Poise: equilibria, motion and parameter identification of planar mechanisms."""

from . import measures
from ._builder import SceneBuilder
from ._commands import design, identifiability, identify, import_, montecarlo, plan, stress, validate
from ._examples import example, example_path, examples
from ._experiment import Experiment
from ._found import Found
from ._many import Many, ManyPaths
from ._poise import Certificate, InputError, System, version
from ._rest import Rest
from ._scene import Scene, load
from ._view import View

__version__ = version
__all__ = ["Certificate", "Experiment", "Found", "InputError", "Many", "ManyPaths", "Rest", "Scene", "SceneBuilder",
           "System", "View", "design", "example", "example_path", "examples", "identifiability", "identify", "import_",
           "load", "measures", "montecarlo", "plan", "stress", "validate"]
