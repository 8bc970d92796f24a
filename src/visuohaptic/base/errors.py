"""The errors that a caller can act on; each message is one sentence that names the way out."""


class VisuohapticError(Exception):
    """Base of every error that this package raises on purpose."""


class MeshError(VisuohapticError):
    """A mesh file can't be read, or has nothing that can be touched."""


class MeshWarning(UserWarning):
    """A mesh file was read, and lacks what it refers to or may be meant in another way."""


class CatalogueError(VisuohapticError):
    """The catalogue of objects, or a name in it, is not usable."""


class DownloadError(VisuohapticError):
    """A model can't be had, or what came is not what the catalogue pins."""


class ParameterError(VisuohapticError):
    """`params.yaml` holds a value that is not allowed."""


class RegistryError(VisuohapticError):
    """A name is not registered, or what is declared and what is implemented differ."""


class PlugInError(RegistryError):
    """A plug-in is missing, fails, or registers nothing that can be registered."""


class PolicyError(VisuohapticError):
    """A policy raised, or chose a place that can't be touched."""


class TableError(VisuohapticError):
    """A table breaks its schema."""


class RecognitionError(VisuohapticError):
    """The features at hand don't allow the experiment that was asked for."""


class MissingPackageError(VisuohapticError):
    """A package that this command needs is not installed."""


class ReportError(VisuohapticError):
    """The report can't be made from the tables at hand."""


class ExportError(VisuohapticError):
    """The touches can't be exported, or the folder is not free for them."""
