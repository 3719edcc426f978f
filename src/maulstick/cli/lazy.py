"""Commands that are loaded when they are called; until then each is a name and one line of help."""

from importlib import import_module
from typing import Any, Final

import typer
from typer.core import TyperCommand, TyperGroup

from maulstick.cli.loading import no_garbage

SUMMARIES: Final = {
    "plan": "Plan a painting of a picture or a text.",
    "edit": "Change strokes of a painting by hand; `maulstick plan --again` then plans the rest around "
    "the locked ones.",
    "sweep": "Plan every combination of some options, each in a folder of its own.",
    "paint": "Let a machine paint a painting, or draw an SVG.",
    "machine": "Move a machine with keys, set where the sheet begins and how high the pen is, and try both.",
    "render": "Draw a painting, or an SVG as a pen would draw it, as an image of any size.",
    "show": "Draw a picture of ink, strokes, a style, a brush, a painting or an SVG.",
    "compare": "Draw paintings side by side at one scale, and print a table of their numbers.",
    "mix": "Print recipes to mix the paints of a painting from tubes.",
    "export": "Write a painting for a machine that another program drives, with its strokes in a quick order.",
    "studio": "Draw strokes, learn styles, plan, mix and paint on a page in a browser, until Ctrl-C.",
    "survey": "Ask people about drawings on the pages of a survey, until Ctrl-C.",
    "doctor": "Show what is installed and connected, what works, and what to do for the rest; takes a few seconds.",
    "record": "Read a recording of a person drawing, and write its ink.",
    "style": "Learn a style from strokes of one hand, look at styles and compare them.",
    "brush": "Fit a brush to photographs of its strokes, and look at brushes.",
    "calibrate": "Measure where the sheet lies, what a camera sees, and how a brush paints.",
}
"""First line of help by the name of the command, which is its module's in this package, too."""


class _Listed(TyperCommand):
    """A command as it stands in the list of them."""

    def load(self) -> Any:
        """The command itself."""
        name = str(self.name)
        with no_garbage():
            found = getattr(import_module(f"maulstick.cli.{name}"), name)
        alone = typer.Typer(rich_markup_mode="markdown", add_completion=False)
        if isinstance(found, typer.Typer):
            alone.add_typer(found, name=name)
        else:
            alone.command(name)(found)
        return typer.main.get_group(alone).commands[name]


class LazyGroup(TyperGroup):
    """Group of all commands, of which the one that is called is loaded, and those that are only listed are not."""

    def __init__(self, **options: Any) -> None:
        super().__init__(**options)
        self.commands = {name: _Listed(name=name, help=line) for name, line in SUMMARIES.items()}

    def resolve_command(self, ctx: Any, args: list[str]) -> tuple[str | None, Any, list[str]]:
        """The name of the command that the arguments call, the command, and the arguments that it gets."""
        name, command, rest = super().resolve_command(ctx, args)
        return name, loaded(command), rest


def loaded(command: Any) -> Any:
    """The command that one of the list stands for; any other is returned as it is."""
    return command.load() if isinstance(command, _Listed) else command
