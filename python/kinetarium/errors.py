"""What can go wrong. All messages name the place and the remedy, and are the same as in Rust but for options."""


class KinetariumError(Exception):
    """Base of all exceptions of this package."""


class ModelError(KinetariumError, ValueError):
    """A model that cannot be, such as a body of negative mass."""


class FileError(KinetariumError, ValueError):
    """A file that cannot be read, is malformed, or uses what is not supported; with file and line."""


class SimulationError(KinetariumError, ValueError):
    """A setting that makes no sense, a number that is not finite, a snapshot that does not fit."""


class DeviceError(KinetariumError, RuntimeError):
    """A device that is not there, does not take a simulation, or has failed."""


class ShapeError(KinetariumError, ValueError):
    """An array of the wrong shape, dtype or memory order."""


class OutOfRangeError(KinetariumError, IndexError):
    """An index beyond the end: a world, a degree of freedom."""


class UnknownNameError(KinetariumError, LookupError):
    """A name that nothing has; the message suggests one that exists."""


class BusyError(KinetariumError, RuntimeError):
    """Another thread is using the simulation, or a sensor of one's own that may only read it."""


class ClosedError(KinetariumError, RuntimeError):
    """The simulation was closed."""


class ForkedError(KinetariumError, RuntimeError):
    """The simulation is of the process that this one was forked from."""


class SensorError(KinetariumError, ValueError):
    """A sensor that cannot be, such as one of a negative rate."""


class RenderError(KinetariumError, ValueError):
    """A camera that cannot be, or a scene that cannot be drawn."""


class SkinError(KinetariumError, ValueError):
    """A skin that cannot be, such as a colour beyond 1."""


class ViewerError(KinetariumError, OSError):
    """A page that cannot be served, as where the address is taken."""
