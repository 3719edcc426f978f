"""The documents that come with Maulstick."""

import re
import shlex
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest
import typer
from typer.core import TyperGroup

from maulstick.cli.app import app
from maulstick.cli.lazy import SUMMARIES, loaded

ROOT = Path(__file__).resolve().parents[1]
DOCUMENTS = sorted([*ROOT.glob("*.md"), *(ROOT / "docs").rglob("*.md")])
NAMING_CODE = [path for path in DOCUMENTS if path.name != "CHANGELOG.md"]  # it names what was, too
COMMANDS = typer.main.get_command(app)


@pytest.mark.parametrize("document", DOCUMENTS, ids=lambda path: path.name)
def test_every_link_to_a_file_leads_to_one(document: Path) -> None:
    links = re.findall(r"\]\(([^)#\s]+)(?:#[^)\s]*)?\)", document.read_text(encoding="utf-8"))
    assert [link for link in links if "://" not in link and not (document.parent / link).exists()] == []


@pytest.mark.parametrize("document", DOCUMENTS, ids=lambda path: path.name)
def test_every_link_to_a_section_leads_to_one(document: Path) -> None:
    links = re.findall(r"\]\(([^)#\s:]*)#([^)\s]+)\)", document.read_text(encoding="utf-8"))
    assert [
        link for link in links if link[1] not in sections_of((document.parent / link[0]) if link[0] else document)
    ] == []


def test_the_package_its_citation_and_the_newest_changes_have_one_version() -> None:
    package = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["version"]
    newest = re.search(r"^## \[([\d.]+)\]", (ROOT / "CHANGELOG.md").read_text(encoding="utf-8"), re.MULTILINE)
    cited = re.search(r"^version: (.+)$", (ROOT / "CITATION.cff").read_text(encoding="utf-8"), re.MULTILINE)
    assert newest is not None
    assert cited is not None
    assert newest[1] == cited[1] == package


@pytest.mark.parametrize("document", DOCUMENTS, ids=lambda path: path.name)
def test_every_script_that_a_document_runs_is_there(document: Path) -> None:
    scripts = re.findall(r"(?:benchmarks|experiments|examples)/\w+\.py", document.read_text(encoding="utf-8"))
    assert [script for script in scripts if not (ROOT / script).exists()] == []


def test_the_page_of_rooms_names_every_file_that_lies_in_one() -> None:
    rows = re.findall(
        r"^\| `(\w+)/` \| (.*) \|$", (ROOT / "docs" / "rooms.md").read_text(encoding="utf-8"), re.MULTILINE
    )
    said = {room: set(re.findall(r"`(\w+)`", text)) for room, text in rows}
    files = {path for path in (ROOT / "src" / "maulstick").glob("*/*.py") if path.stem != "__init__"}
    told_together = {"cli", "plots"}  # one file per command, and per kind of picture
    others = (path for path in files if path.parent.name not in told_together)
    assert sorted(f"{path.parent.name}/{path.name}" for path in others if path.stem not in said[path.parent.name]) == []


@pytest.mark.parametrize("document", NAMING_CODE, ids=lambda path: path.name)
def test_every_path_of_code_that_a_document_names_is_there(document: Path) -> None:
    paths = re.findall(r"\b(?:src/maulstick|tests)/[\w./-]*\w", document.read_text(encoding="utf-8"))
    assert [path for path in paths if not (ROOT / path).exists()] == []


@pytest.mark.parametrize("document", NAMING_CODE, ids=lambda path: path.name)
def test_every_module_that_a_document_names_is_there(document: Path) -> None:
    names = re.findall(r"(?<![\w./])maulstick(?:\.\w+)+", document.read_text(encoding="utf-8"))
    assert [name for name in names if not is_module_or_in_one(name)] == []


@pytest.mark.parametrize("document", NAMING_CODE, ids=lambda path: path.name)
def test_every_command_and_option_that_a_document_names_is_there(document: Path) -> None:
    text = document.read_text(encoding="utf-8")
    assert [line for line in commands_in(text) if not is_understood(line)] == []


def test_commands_are_found_in_code_and_in_blocks() -> None:
    text = "Say `maulstick plan a.jpg` or\n\n    .venv/bin/maulstick paint --dry-run  # now\n\nto maulstick's easel."
    assert commands_in(text) == ["maulstick plan a.jpg", "maulstick paint --dry-run  # now"]


@pytest.mark.parametrize(
    "line",
    ["maulstick scribble", "maulstick plan --canvas x", "maulstick record ink x --pivot y", "maulstick style paint x"],
)
def test_commands_and_options_that_are_not_there_are_noticed(line: str) -> None:
    assert not is_understood(line)


@pytest.mark.parametrize(
    "line",
    [
        "maulstick plan photo.jpg --weight edges=1 --out cat",
        "maulstick calibrate tags|camera|colours|touch|brush",
        "maulstick style fit",
        "maulstick --version",
        "maulstick plan --text 'a sailing boat'  # pip install --no-such-option",
    ],
)
def test_commands_and_options_that_are_there_are_understood(line: str) -> None:
    assert is_understood(line)


def test_modules_and_names_in_them_are_told_from_what_is_not_there() -> None:
    assert is_module_or_in_one("maulstick.robot.check.check_robot")
    assert is_module_or_in_one("maulstick.painting")
    assert not is_module_or_in_one("maulstick.robot.check.check_robots")
    assert not is_module_or_in_one("maulstick.canvas")


def test_the_page_of_commands_has_all_of_them_with_their_options(tmp_path: Path) -> None:
    made = [sys.executable, str(ROOT / "experiments" / "commands.py"), "--out", str(tmp_path / "commands.md")]
    subprocess.run(made, check=True, capture_output=True)
    page = (tmp_path / "commands.md").read_text(encoding="utf-8")
    for name, line in SUMMARIES.items():
        assert f"* `{name}`: {line}\n" in page
        section = page.partition(f"\n## `maulstick {name}`\n")[2].partition("\n## ")[0]
        options = [each for parameter in loaded(COMMANDS.commands[name]).params for each in parameter.opts]
        assert [option for option in options if option.startswith("--") and f"`{option}" not in section] == []
    assert "\n### `maulstick calibrate touch`\n" in page


def sections_of(document: Path) -> set[str]:
    """Anchors of a document's headings, as pages of repositories have them."""
    headings = re.findall(r"^#+ (.+)$", document.read_text(encoding="utf-8"), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


def is_module_or_in_one(name: str) -> bool:
    """Whether a dotted name is a module or package of Maulstick, or a word in the file of one."""
    path = ROOT / "src" / Path(*name.split("."))
    if path.is_dir() or path.with_suffix(".py").exists():
        return True
    files = [path.parent.with_suffix(".py"), path.parent / "__init__.py"]
    return any(re.search(rf"\b{path.name}\b", file.read_text("utf-8")) for file in files if file.exists())


def commands_in(text: str) -> list[str]:
    """Lines of indented and fenced blocks that run maulstick, and what stands between backquotes and begins with it."""
    inline = re.findall(r"(?<!`)`(?:\.venv/bin/)?(maulstick [^`]+)`(?!`)", text)
    blocks = re.findall(r"^(?: {4}|\.)\S*?(?:venv/bin/)?(maulstick [^\n`]+)$", text, re.MULTILINE)
    return [" ".join(line.split()) for line in inline] + blocks


def is_understood(line: str) -> bool:
    """Whether the command of a line, and all options before the first comment, are the command line's."""
    _, *words = shlex.split(line, comments=True)
    command, allowed = COMMANDS, set[str]()
    while words and isinstance(command, TyperGroup) and not words[0].startswith("-"):
        names = words.pop(0).split("|")
        if not all(name in command.commands for name in names):
            return False
        command = loaded(command.commands[names[0]])
    for parameter in command.params:
        allowed |= {*parameter.opts, *parameter.secondary_opts}
    options = {word.partition("=")[0] for word in words if word.startswith("--")}
    return options <= allowed | {"--help", "--install-completion", "--show-completion"}
