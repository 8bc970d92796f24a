"""Errors that a caller can handle; each message is one sentence that says what to do."""


class VisuohapticError(Exception):
    """Base class of all errors of this package."""


class EndlessLoopError(VisuohapticError):
    """A loop took more turns than any input needs: a mistake in this package."""


class StorageError(VisuohapticError, OSError):
    """A file can't be written, because its disk is full, read-only or broken."""


class MeshError(VisuohapticError):
    """A mesh file can't be read, or has no surface that can be touched."""


class MeshWarning(UserWarning):
    """A mesh file was read, but a file that it refers to is missing, or its meaning is ambiguous."""


class LayoutWarning(UserWarning):
    """A pad is wider than the object: its lengths may be millimetres that are read as metres."""


class RecognitionWarning(UserWarning):
    """A classifier can be evaluated, but scales its input in a way that drowns the differences of classes in noise."""


class CatalogueError(VisuohapticError):
    """The catalogue of objects, or a name in it, is not allowed."""


class FolderError(VisuohapticError):
    """A folder for a run can't be made or used, because of its files, its path, permissions or another run."""


class DownloadError(VisuohapticError):
    """A model can't be downloaded, or its digest differs from the digest in the catalogue."""


class ParameterError(VisuohapticError):
    """`params.yaml` holds a value that is not allowed."""


class RegistryError(VisuohapticError):
    """A name is not registered, is registered already, or can't be registered."""


class PlugInError(RegistryError):
    """A plug-in is missing, fails, or registers nothing that can be registered."""


class PolicyError(VisuohapticError):
    """A policy raised an error, took longer than its bound, or chose a location that can't be touched.

    Attribute `policy` is the policy's name among the strategies; ``""`` if the policy is no strategy.
    """

    def __init__(self, message: str, policy: str = "") -> None:
        super().__init__(message)
        self.policy = policy


class TableError(VisuohapticError):
    """A table breaks its schema."""


class RecognitionError(VisuohapticError):
    """The features or a recognition parameter don't allow the requested recognition."""


class MissingPackageError(VisuohapticError):
    """A package that this command needs is not installed."""


class ReportError(VisuohapticError):
    """The tables of the run are not sufficient for the report."""


class ExportError(VisuohapticError):
    """The touches can't be exported, or the folder of the export is not empty."""
