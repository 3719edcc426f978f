"""Words of the command line for errors: its options and remedies."""

from typing import TYPE_CHECKING, Final

from maulstick.errors import Remedy, Wording

if TYPE_CHECKING:
    from maulstick.robot.robot import Robot

COMMAND_LINE: Final = Wording(
    option=lambda name: f"--{name.replace('_', '-')}",
    machine=str,
    remedies={
        Remedy.RESUME_OR_RESTART: "go on with --resume, or start on a new sheet with --restart",
        Remedy.RESTART: "start again with --restart",
        Remedy.PUT_BACK_OR_RESTART: "put that one back, or start again with --restart",
        Remedy.MEND_OR_RESTART: "mend it, or start again with --restart",
        Remedy.START: "leave out --resume",
        Remedy.SAME_MACHINE_OR_RESTART: "leave out --robot, or start on a new sheet with --restart",
        Remedy.GO_ON: "then go on with maulstick paint ... --resume",
        Remedy.NAME_PICTURE: "name it with --picture",
        Remedy.NAME_CAMERA: "name it with --camera usb:0, or folder:PATH",
        Remedy.LEAVE_OUT_CAMERA: "leave out --camera",
        Remedy.WITHOUT_REPLAN: "go on with --replan 0",
        Remedy.SAME_DRAWING_OR_RESTART: "leave them out, or start on a new sheet with --restart",
        Remedy.HOLD_PRESSURE: "plan it again with maulstick plan --pressure 0.5",
        Remedy.SLOW_DOWN: "slow all strokes down with --speed {millimetres}",
        Remedy.CLIP_WEIGHTS: "give a file of them with --clip-weights",
        Remedy.MAKE_INK: "make ink of it with maulstick record ink",
        Remedy.CLIP_WEIGHTS_OR_NETWORK: "give a file of them with --clip-weights, or try again with a network",
    },
)


def stopped(robot: "Robot") -> str:
    """Return a sentence about a machine that has stopped: whether its pen is off the paper."""
    return f"stopped, {'with the pen lifted' if robot.lifted else 'and the pen may still be down: lift it by hand'}"
