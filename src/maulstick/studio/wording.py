"""Wording of the studio's page: names of machines and options, and texts of errors."""

from typing import TYPE_CHECKING, Final

from maulstick.errors import MaulstickError, Remedy, Wording
from maulstick.robot.machines import FILE, is_simulated, kind_of

if TYPE_CHECKING:
    from maulstick.robot.routine import Prompt

MACHINES: Final = {
    "sim": "Simulated easel, as fast as it can",
    "sim:pens": "Simulated easel, pens put in by you",
    "sim:real": "Simulated easel, at an arm's pace",
    "grbl": "Pen plotter with Grbl",
    "axidraw": "AxiDraw",
    "lite6": "UFACTORY Lite 6",
    "xarm": "UFACTORY xArm",
    "franka": "Franka arm",
    "ur": "Universal Robots arm",
}
"""Names of machines for people, by the kind that a spec begins with."""

PLANNED_FOR: Final = {
    "": "None yet: to look at",
    **{kind: name for kind, name in MACHINES.items() if not is_simulated(kind)},
    FILE: "Another pen plotter, by a file",
}
"""Names of the machines that a plan can be for, by kind."""

DETAILS_LABEL = "Speed, sheet, camera and copies"
"""Label of the part of the form that is closed at first."""

RESTART_LABEL = "Start again on a new sheet"
"""Label of the button that begins a painting anew."""

BY_HAND_LABEL = "Set the machine up by hand"
"""Label of the panel in which a machine is moved by hand."""

LOOK_AT_IT = "Look at the machine: its pen may still be down."
"""Sentence after an end of which the machine told nothing."""

WORDS_LABEL = "What to paint, in words"
"""Label of the field for a text that is to be painted."""


def machine_name(spec: str) -> str:
    """Return the name of a machine for people, out of its spec such as ``grbl:/dev/ttyUSB0``."""
    kind, _, address = spec.partition(":")
    if spec in MACHINES:
        return MACHINES[spec]
    return MACHINES.get(kind, kind) + (f" at {address}" if address else "")


def planned_for(spec: str) -> str:
    """Return the name of a machine that a plan is for, within a sentence, out of its spec or its kind."""
    kind = kind_of(spec)
    name = PLANNED_FOR.get(kind, machine_name(spec))
    return name[0].lower() + name[1:] if name.startswith(("Pen ", "Another ")) else name


def error_text(error: MaulstickError) -> str:
    """Return the text of an error in the words of the page."""
    return _PAGE.say(error)


def prompt_text(prompt: "Prompt") -> str:
    """Return what a machine asks its operator for, in the words of the page."""
    return prompt.told(_PAGE)


_OPTIONS: Final = {
    "speed": "the speed",
    "replan": "the number of strokes between two looks",
    "hatch": "the distance between hatching lines",
    "join": "the distance of ends that are joined",
    "px": "sheet",
    "paper": "the colour of the paper",
    "background": "the photograph of the sheet",
    "pause_at": "the number of a stroke to wait before",
    "name": "name",
    "out": "folder",
}
"""Names of options on the page; others keep their own names, with spaces for underscores."""

_PAGE: Final = Wording(
    option=lambda name: _OPTIONS.get(name, name.replace("_", " ")),
    machine=machine_name,
    remedies={
        Remedy.RESUME_OR_RESTART: f"“Go on where it stopped”, or “{RESTART_LABEL}”",
        Remedy.RESTART: f"“{RESTART_LABEL}”",
        Remedy.PUT_BACK_OR_RESTART: f"put that one back, or “{RESTART_LABEL}”",
        Remedy.MEND_OR_RESTART: f"mend it, or “{RESTART_LABEL}”",
        Remedy.START: "start it",
        Remedy.SAME_MACHINE_OR_RESTART: f"choose that machine, or “{RESTART_LABEL}”",
        Remedy.GO_ON: "then “Go on where it stopped”",
        Remedy.HOME: f"“{BY_HAND_LABEL}” homes it; without switches turn it off and on with its pen at home",
        Remedy.FIND_HOME: f"home it under “{BY_HAND_LABEL}”",
        Remedy.UNLOCK: f"“{BY_HAND_LABEL}” homes or unlocks it; then start again",
        Remedy.NAME_PICTURE: "choose a plan of a picture, or no camera",
        Remedy.NAME_CAMERA: "choose one",
        Remedy.LEAVE_OUT_CAMERA: "choose that one, or none",
        Remedy.WITHOUT_REPLAN: "go on without a camera",
        Remedy.WITHOUT_DRAWING: "leave out how a drawing is read",
        Remedy.SAME_DRAWING_OR_RESTART: f"choose those again, or “{RESTART_LABEL}”",
        Remedy.HOLD_PRESSURE: "plan it again with this machine chosen under Plan, or choose another machine",
        Remedy.SLOW_DOWN: f"slow all strokes down: write {{millimetres}} under “{DETAILS_LABEL}”",
        Remedy.CALIBRATE_TOUCH: f"bring its easel file under “{DETAILS_LABEL}”",
        Remedy.FIND_DEPTH: f"bring its easel file under “{DETAILS_LABEL}”, or where a servo lifts the pen, keep one "
        f"under “{BY_HAND_LABEL}”",
        Remedy.NAME_PORT: "connect its USB cable and power, or choose its port",
        Remedy.CLIP_WEIGHTS: f"take out what stands under “{WORDS_LABEL}”, and use a picture",
        Remedy.CLIP_WEIGHTS_OR_NETWORK: "connect this computer to the internet and try again, or take out what stands "
        f"under “{WORDS_LABEL}”, and use a picture",
        Remedy.READ_TAKE: "bring the ink that maulstick record motive makes of it",
    },
)
