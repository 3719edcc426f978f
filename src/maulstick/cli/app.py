"""All commands of the command line."""

import sys
from typing import Annotated, Any, Final

import typer

from maulstick.cli.exit_codes import STOPPED, UNUSABLE
from maulstick.cli.lazy import LazyGroup, loaded

_UsageError: Final[Any] = typer.BadParameter.__base__  # Click's, or that of the copy of Click within Typer

app = typer.Typer(
    cls=LazyGroup,
    rich_markup_mode="markdown",
    add_completion=True,
    no_args_is_help=True,
    pretty_exceptions_enable=False,
)


def _print_version(wanted: bool) -> None:
    if wanted:
        from importlib.metadata import version

        print(f"maulstick {version('maulstick')}")
        raise typer.Exit


@app.callback(
    epilog="Exit codes: 0 done; 1 a result could not be written; 2 a file or an option cannot be used; "
    "3 a machine or a camera failed; 130 stopped with Ctrl-C (plan and sweep save the plans so far)."
)
def maulstick(
    version: Annotated[
        bool,
        typer.Option(
            "--version", metavar="", callback=_print_version, is_eager=True, help="Print the version and exit."
        ),
    ] = False,
) -> None:
    """Plan paintings out of strokes that a pen plotter or a robot can paint.

    Example: maulstick plan photo.jpg --out cat
    """


def run() -> int:
    """Run the command that the arguments name, and return its exit code; a wrong argument is one line."""
    try:
        code = app(prog_name="maulstick", standalone_mode=False)  # so that errors come here, and are not drawn in a box
    except typer.Abort:
        return STOPPED
    except _UsageError as error:
        if type(error).__name__ != "NoArgsIsHelpError":  # the help is printed by then
            print(f"maulstick: {_usage_fault(error)}", file=sys.stderr)
        return UNUSABLE
    return code if isinstance(code, int) else 0


def _usage_fault(error: Any) -> str:
    """Return Click's sentence in the form of ours: a fault, and after a semicolon where to read on."""
    fault = error.message if hasattr(error, "option_name") else error.format_message()  # the latter guesses at options
    fault = " ".join(fault.split()).replace(". Did you mean ", "; there is ").rstrip(".?")
    named = "maulstick"
    command: Any = typer.main.get_command(app)  # error.ctx is not always there
    for argument in sys.argv[1:]:
        if (command := getattr(command, "commands", {}).get(argument)) is None:
            break
        command = loaded(command)
        named += f" {argument}"
    return f"{fault[:1].lower()}{fault[1:]}; see {named} --help"
