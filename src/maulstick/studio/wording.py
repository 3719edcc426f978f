"""How the studio's page calls machines, and how it says errors."""

from typing import Final

from maulstick.errors import MaulstickError, Remedy, Wording

MACHINES: Final = {
    "sim": "Simulated easel, as fast as it can",
    "sim:real": "Simulated easel, at an arm's pace",
    "grbl": "Pen plotter with Grbl",
    "axidraw": "AxiDraw",
    "lite6": "UFACTORY Lite 6",
    "xarm": "UFACTORY xArm",
    "franka": "Franka arm",
    "ur": "Universal Robots arm",
}
"""Machines by the words that name them, without an address."""

FINER = "Speed, sheet and camera"
"""Where the finer points are asked for."""

RESTART = "Start again on a new sheet"
"""The button for that."""


def name_of(machine: str) -> str:
    """A machine by its word, for people."""
    kind, _, address = machine.partition(":")
    if machine in MACHINES:
        return MACHINES[machine]
    return f"{MACHINES.get(kind, kind)} at {address}"


def said(error: MaulstickError) -> str:
    """The error in the words of the page."""
    return _PAGE.say(error)


_OPTIONS: Final = {
    "speed": "the speed",
    "replan": "the number of strokes between two looks",
    "px": "size of the plan",
    "name": "name",
    "out": "folder",
}
"""What the page calls options; those left out are called by their names."""

_PAGE: Final = Wording(
    option=lambda name: _OPTIONS.get(name, name.replace("_", " ")),
    machine=name_of,
    remedies={
        Remedy.RESUME_OR_RESTART: f"“Go on where it stopped”, or “{RESTART}”",
        Remedy.RESTART: f"“{RESTART}”",
        Remedy.PUT_BACK_OR_RESTART: f"put that one back, or “{RESTART}”",
        Remedy.MEND_OR_RESTART: f"mend it, or “{RESTART}”",
        Remedy.START: "start it",
        Remedy.SAME_MACHINE_OR_RESTART: f"choose that machine, or “{RESTART}”",
        Remedy.GO_ON: "then “Go on where it stopped”",
        Remedy.NAME_PICTURE: "choose a plan of a picture, or no camera",
        Remedy.NAME_CAMERA: "choose one",
        Remedy.LEAVE_OUT_CAMERA: "choose that one, or none",
        Remedy.WITHOUT_REPLAN: "go on without a camera",
        Remedy.HOLD_PRESSURE: "choose another machine, or a plan whose brush is a pen",
        Remedy.SLOW_DOWN: f"slow all strokes down: write {{speed}} under “{FINER}”",
        Remedy.CALIBRATE_TOUCH: f"bring its easel file under “{FINER}”",
        Remedy.NAME_PORT: "connect its USB cable and power, or choose its port",
        Remedy.CLIP_WEIGHTS: "plan it on the command line, which takes a file of weights",
        Remedy.CLIP_WEIGHTS_OR_NETWORK: "plan it on the command line, which takes a file of weights",
        Remedy.READ_TAKE: "bring the ink that maulstick record motive makes of it",
    },
)
