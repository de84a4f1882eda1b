"""Recordings of a Velodyne lidar, also on a tilting platform, as numpy arrays.

read and frames give points; Log what a log holds; plan, density, k, calibrate and simulate do what the
commands of velomotion with these names do. Work runs without the interpreter's lock, arrays are not
copied, and errors are velomotion.Error.
"""

from ._errors import (
    Error,
    FileError,
    IncompleteError,
    IncompleteWarning,
    InputError,
    RecordingWarning,
    UsageError,
)
from ._velomotion import Frames, Log, __version__, calibrate, density, frames, k, plan, read, simulate

__all__ = [
    "Error",
    "FileError",
    "Frames",
    "IncompleteError",
    "IncompleteWarning",
    "InputError",
    "Log",
    "RecordingWarning",
    "UsageError",
    "__version__",
    "calibrate",
    "density",
    "frames",
    "k",
    "plan",
    "read",
    "simulate",
]
