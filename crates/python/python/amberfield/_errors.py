"""Exceptions, one class for each exit code of the command."""


class AmberfieldError(Exception):
    """Failure with the text that the command ``amberfield`` would print."""

    #: Exit code that the command would have.
    exit_code = 1


class InputError(AmberfieldError, ValueError):
    """Input that is wrong: the text names the place, the value, and what to do."""

    exit_code = 2


class PeerError(AmberfieldError, ConnectionError):
    """Field solver of another process that was lost or does not answer."""

    exit_code = 3


class ToleranceError(AmberfieldError, ArithmeticError):
    """Answer outside its tolerance. What was computed is in :attr:`values`, or in the run's folder."""

    exit_code = 4
    #: Field that was computed; None for a run.
    values = None


class Interrupted(AmberfieldError, KeyboardInterrupt):
    """Work that was stopped before it could be saved."""

    exit_code = 130


_OF_CODE = {kind.exit_code: kind for kind in (InputError, PeerError, ToleranceError, Interrupted)}


def of_code(code, message):
    """Exception of an exit code."""
    return _OF_CODE.get(code, AmberfieldError)(message)
