"""What can go wrong, each error written from the value that came and the values that would have been valid."""

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pydantic import ValidationError


class MaulstickError(Exception):
    """Anything a user can mend; the message is one sentence for them."""


class InputError(MaulstickError, ValueError):
    """A value, an option or a file that cannot be used."""

    @classmethod
    def of_range(cls, name: str, value: object, allowed: str) -> "InputError":
        """`name` is `value`, which is outside what is `allowed`."""
        return cls(f"{name} is {value}; it must be {allowed}")

    @classmethod
    def of_choice(cls, name: str, value: object, valid: Iterable[str]) -> "InputError":
        """`name` is `value`, which is none of the `valid` ones."""
        return cls(f"there is no {name} {str(value)!r}; there are: {', '.join(sorted(valid))}")


class OutputError(MaulstickError, OSError):
    """A result that could not be written."""


class MachineError(MaulstickError):
    """A machine or a camera that does not do what it should; whatever moved stands still, with the pen lifted."""


def validation_fault(error: "ValidationError") -> str:
    """The first thing that a model refused, as ``field: what is wrong with it (got …)``."""
    fault = error.errors()[0]
    field = _dotted(fault["loc"]) or "the file"
    came = repr(fault["input"])
    return f"{field}: {fault['msg']} (got {came if len(came) <= 60 else came[:57] + '...'})"


def _dotted(location: Sequence[int | str]) -> str:
    return "".join(f"[{part}]" if isinstance(part, int) else f".{part}" for part in location).lstrip(".")
