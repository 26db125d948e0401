"""What Kairos cannot do: one line that says what, where, and what to do."""


class Error(Exception):
    """The base of all of Kairos' errors. Its text is one line: what, where, and what to do."""


class InputError(Error, ValueError):
    """A file or a scene that cannot be used."""


class UsageError(Error, ValueError):
    """Arguments that make no sense, among them arrays of the wrong shape."""


class FileError(Error, OSError):
    """The system refused to read or write."""


class Cancelled(Error):
    """The progress function returned False."""


for _each in (Error, InputError, UsageError, FileError, Cancelled):
    _each.__module__ = "kairos"
