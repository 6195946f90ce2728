"""What goes wrong, as exceptions."""

from __future__ import annotations

import enum


class StatusCode(enum.IntEnum):
    """The codes of gRPC, with its numbers."""

    CANCELLED = 1
    UNKNOWN = 2
    INVALID_ARGUMENT = 3
    DEADLINE_EXCEEDED = 4
    NOT_FOUND = 5
    ALREADY_EXISTS = 6
    PERMISSION_DENIED = 7
    RESOURCE_EXHAUSTED = 8
    FAILED_PRECONDITION = 9
    ABORTED = 10
    OUT_OF_RANGE = 11
    UNIMPLEMENTED = 12
    INTERNAL = 13
    UNAVAILABLE = 14
    DATA_LOSS = 15
    UNAUTHENTICATED = 16


class Error(Exception):
    """A failure of the mesher, of the network or of a server.

    The text says what was wrong, with the value and the limit, and `code` of what kind it is. For programs,
    as far as they are known, which is more where a server took part:

    reason         a word as docs/errors.md lists them ("GRID_NOT_FOUND"); else empty
    field          the request's field that is wrong ("mesh.spacing"); else empty
    what, value, limit   what is over a limit, how much that is, and the limit; else "", None, None
    request_id     the call's, in the server's log; else empty
    """

    code: StatusCode
    reason: str

    def __init__(
        self,
        message: str,
        code: int = StatusCode.UNKNOWN,
        reason: str = "",
        field: str = "",
        what: str = "",
        value: int | None = None,
        limit: int | None = None,
        request_id: str = "",
    ) -> None:
        super().__init__(message)
        self.message = message
        self.code = StatusCode(code)
        self.reason = reason
        self.field = field
        self.what = what
        self.value = value
        self.limit = limit
        self.request_id = request_id

    def __reduce__(self) -> tuple[type[Error], tuple[object, ...]]:
        return type(self), (self.message, int(self.code), self.reason, self.field, self.what, self.value,
                            self.limit, self.request_id)

    def __str__(self) -> str:
        return self.message


class InvalidArgumentError(Error, ValueError):
    """An argument has a value that it may not have, or a file is not what its name says."""


class FailedPreconditionError(Error):
    """No surface at this iso value, an inside without an end, a grid that cannot be meshed."""


class NotFoundError(Error, LookupError):
    """There is no such file, grid or stored volume."""


class ResourceExhaustedError(Error):
    """Something is over a limit: the message has the value and the limit."""


class AccessError(Error):
    """A file or a server refuses: the token is missing, unknown, or not for this call."""


class CancelledError(Error):
    """The work was stopped, for instance by closing its stream."""


class DeadlineExceededError(Error, TimeoutError):
    """The work took longer than its `timeout`."""


class UnavailableError(Error):
    """The server cannot be reached, after all attempts; or the disk, or the file's reader."""


class DataLossError(Error):
    """Bytes of the server are not what they should be."""


class InternalError(Error):
    """A fault of this library or of the server."""


_CLASSES: dict[StatusCode, type[Error]] = {
    StatusCode.CANCELLED: CancelledError,
    StatusCode.INVALID_ARGUMENT: InvalidArgumentError,
    StatusCode.DEADLINE_EXCEEDED: DeadlineExceededError,
    StatusCode.NOT_FOUND: NotFoundError,
    StatusCode.PERMISSION_DENIED: AccessError,
    StatusCode.RESOURCE_EXHAUSTED: ResourceExhaustedError,
    StatusCode.FAILED_PRECONDITION: FailedPreconditionError,
    StatusCode.INTERNAL: InternalError,
    StatusCode.UNAVAILABLE: UnavailableError,
    StatusCode.DATA_LOSS: DataLossError,
    StatusCode.UNAUTHENTICATED: AccessError,
}


def error_of(
    code: int,
    message: str,
    reason: str,
    field: str = "",
    what: str = "",
    value: int | None = None,
    limit: int | None = None,
    request_id: str = "",
) -> Error:
    """The exception that belongs to a status of the library, which calls this."""
    return _CLASSES.get(StatusCode(code), Error)(message, code, reason, field, what, value, limit, request_id)


def invalid(message: str) -> InvalidArgumentError:
    return InvalidArgumentError(message, StatusCode.INVALID_ARGUMENT, "INVALID_FIELD")
