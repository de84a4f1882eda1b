"""Exceptions of velomotion."""

from __future__ import annotations


class Error(Exception):
    """A failure. help says what to do next, in the words of the commands; it may be None."""

    help: str | None = None


class UsageError(Error, ValueError):
    """An argument is invalid."""


class FileError(Error, OSError):
    """A file is missing or cannot be opened."""


class InputError(Error, ValueError):
    """A file is not what it should be: no recording, a damaged configuration, no sweep."""


class IncompleteError(Error):
    """The result would be incomplete: no setting, too little evidence, a full disk."""


class RecordingWarning(UserWarning):
    """A recording contradicts itself or an argument; the result may not be what was meant."""


class IncompleteWarning(UserWarning):
    """Something is missing in a recording; the result has the rest."""
