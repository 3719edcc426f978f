"""All commands with all their options on one page of Markdown, as `--help` says them.

.venv/bin/python experiments/commands.py [--out build/commands.md]
"""

import argparse
from pathlib import Path
from typing import Any

import typer
from typer.cli import get_docs_for_click

from maulstick.cli.app import app
from maulstick.cli.lazy import loaded


def page() -> str:
    """Return the page, with a section per command, made by Typer out of the commands themselves."""
    group = typer.main.get_group(app)
    group.commands = {name: _said_in_full(loaded(command)) for name, command in group.commands.items()}
    text = get_docs_for_click(obj=group, ctx=typer.Context(group), name="maulstick", title="The command line")
    return f"{text.strip()}\n"


def _said_in_full(command: Any) -> Any:
    """Return a command whose first sentence, and those of its own commands, are not cut short in lists."""
    command.short_help = (command.help or "").split("\n\n")[0]
    for each in getattr(command, "commands", {}).values():
        _said_in_full(each)
    return command


def main() -> None:
    """Write the page, and print where it is."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=Path, default=Path("build/commands.md"))
    out = parser.parse_args().out
    out.parent.mkdir(parents=True, exist_ok=True)
    out.write_text(page(), encoding="utf-8")
    print(out)


if __name__ == "__main__":
    main()
