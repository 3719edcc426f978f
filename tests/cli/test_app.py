import os
import re
import shlex
import subprocess
import sys
from collections.abc import Iterator
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import typer

from maulstick.cli.app import app
from maulstick.cli.lazy import SUMMARIES, loaded
from maulstick.strokes.ink import Ink, write_ink
from tests.cli.conftest import COMMAND, run, run_command


def test_the_version_is_the_one_that_is_installed() -> None:
    assert run("--version") == (0, f"maulstick {version('maulstick')}\n", "")


def test_without_a_word_it_says_which_words_there_are() -> None:
    ran = run()
    assert ran.code == 2
    assert "paint" in ran.stdout
    assert "render" in ran.stdout


def test_help_says_what_each_exit_code_means() -> None:
    ran = run("--help")
    assert ran.code == 0
    for meaning in ("0 done", "1 a result could not be written", "2 a file or an option", "130 stopped with Ctrl-C"):
        assert meaning in " ".join(ran.stdout.split())


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["plann"], "no such command 'plann'; there is 'plan'"),
        (["style", "frobnicate"], "no such command 'frobnicate'"),
        (["--colour"], "no such option: --colour"),
        (["render"], "missing argument 'painting'"),
        (["style", "fit", "me.ink.npz"], "missing option '--name'"),
        (["paint", "a\nb", "more"], "got unexpected extra argument"),
    ],
)
def test_arguments_that_cannot_be_read_are_one_line_that_names_the_help(words: list[str], said: str) -> None:
    ran = run(*words)
    assert ran.code == 2
    assert ran.mistake.lower().startswith(said)
    command, _, rest = ran.mistake.rpartition("; see ")[2].rpartition(" ")
    assert (run(*command.split()[1:], "--help").code, rest) == (0, "--help")


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["studio", "--port", "99999"], "the port is 99999; it must be from 0 to 65535"),
        (["plan", "--text", "a boat", "--clip-weights", "nix"], "there is no file of CLIP weights "),
    ],
)
def test_arguments_that_cannot_be_used_are_one_line_that_says_what_came(words: list[str], said: str) -> None:
    ran = run(*words)
    assert ran.code == 2
    assert ran.mistake.startswith(said)


def commands(group: Any, *names: str) -> Iterator[tuple[str, Any]]:
    for name, listed in group.commands.items():
        command = loaded(listed)
        if hasattr(command, "commands"):
            yield from commands(command, *names, name)
        else:
            yield " ".join(["maulstick", *names, name]), command


COMMANDS = dict(commands(typer.main.get_command(app)))


@pytest.mark.parametrize("name", COMMANDS)
def test_every_command_ends_its_help_with_an_example_that_it_can_read(name: str) -> None:
    command = COMMANDS[name]
    assert not re.search(r"^\s*[-+*] ", command.help, re.MULTILINE), "it would be shown as a list"
    example = " ".join(command.help.split("\n\n")[-1].split()).removeprefix("Example: ")
    assert example.startswith(name)
    command.make_context(name, shlex.split(example.removeprefix(name)))


@pytest.mark.parametrize("name", COMMANDS)
def test_every_option_has_a_sentence_that_begins_with_a_noun_or_a_verb(name: str) -> None:
    for parameter in COMMANDS[name].params:
        assert re.match("[A-Z0-9][^.]*", parameter.help or ""), parameter.name
        first = parameter.help.split()[0]
        assert first not in {"Of", "By", "For", "Whose", "Where", "What", "How", "Another", "In", "Without", "From"}
        assert parameter.help.endswith("."), parameter.name


def test_bash_completes_commands_and_options_by_the_script_that_is_shown(tmp_path: Path) -> None:
    script = tmp_path / "completion.bash"
    asked = f"""
        export PATH={COMMAND.parent}:$PATH
        maulstick --show-completion bash > {script} && source {script}
        COMP_WORDS=(maulstick pl); COMP_CWORD=1; _maulstick_completion maulstick; echo ${{COMPREPLY[@]}}
        COMP_WORDS=(maulstick plan --backg); COMP_CWORD=2; _maulstick_completion maulstick; echo ${{COMPREPLY[@]}}
    """
    ran = subprocess.run(["bash", "-c", asked], capture_output=True, text=True, check=True)
    assert ran.stdout.split() == ["plan", "--background"]
    assert ran.stderr == ""


def test_bash_has_the_completion_installed_in_a_home_of_its_own(tmp_path: Path) -> None:
    asked = f"{COMMAND} --install-completion bash; true"
    ran = subprocess.run(
        ["bash", "-c", asked], capture_output=True, text=True, env={**os.environ, "HOME": str(tmp_path)}
    )
    assert "bash completion installed in" in ran.stdout
    assert "_maulstick_completion" in (tmp_path / ".bash_completions" / "maulstick.sh").read_text()
    assert "maulstick.sh" in (tmp_path / ".bashrc").read_text()


def test_the_command_that_is_installed_leaves_with_one_line_and_a_code() -> None:
    ran = run_command("plan", "none.jpg")
    assert ran.code == 2
    assert ran.mistake == f"there is no picture {Path('none.jpg').absolute()}; check its name and folder"


def test_a_mistake_is_found_before_torch_is_loaded(tmp_path: Path) -> None:
    (tmp_path / "torch.py").write_text("raise SystemExit('torch was loaded')")
    there = str(tmp_path)
    for words, text in {
        ("plan", "--demo", "--px", "0"): "--px is 0; it must be from 16 to 32768",
        ("plan", "--demo", "--ink", "octarine"): "'octarine' is not a colour; write a name such as black, or #rrggbb",
        ("render", "none.json"): "there is no painting none.json; check its name and folder",
    }.items():
        assert run_command(*words, PYTHONPATH=there).mistake == text
    assert "torch was loaded" in run_command("plan", "--demo", "--out", tmp_path / "out", PYTHONPATH=there).stderr


def test_ctrl_c_while_the_program_loads_is_no_traceback(tmp_path: Path) -> None:
    (tmp_path / "typer.py").write_text("raise KeyboardInterrupt")
    assert run_command("--help", PYTHONPATH=str(tmp_path)) == (130, "", "")


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="there is no /dev/full")
def test_a_standard_output_that_is_full_is_one_line() -> None:
    full = os.open("/dev/full", os.O_WRONLY)
    try:
        ran = run_command("--version", stdout=full)
    finally:
        os.close(full)
    assert ran.code == 1
    assert ran.mistake == "cannot write to the standard output: No space left on device"


def loaded_by(*words: str) -> set[str]:
    """Modules that the command line has loaded once it has printed what these words ask for."""
    told = "import atexit, sys; atexit.register(lambda: print(*sys.modules, file=sys.stderr))"
    ran = subprocess.run(
        [sys.executable, "-c", f"{told}; import maulstick.cli; maulstick.cli.main()", *words],
        capture_output=True,
        text=True,
        check=True,
    )
    return set(ran.stderr.splitlines()[-1].split())


@pytest.mark.parametrize("words", [["--help"], ["--version"]])
def test_no_command_and_no_large_library_is_loaded_to_list_the_commands(words: list[str]) -> None:
    loaded = loaded_by(*words)
    assert "maulstick.cli.app" in loaded
    assert not {"torch", "numpy", "scipy", "sklearn", "skimage", "PIL", "pydantic", "open_clip"} & loaded
    assert not {f"maulstick.cli.{name}" for name in SUMMARIES} & loaded


def test_no_command_loads_torch_for_its_help() -> None:
    modules = ", ".join(f"maulstick.cli.{name}" for name in SUMMARIES)
    script = f"import sys, {modules}; print(*{{'torch', 'sklearn', 'open_clip'}} & set(sys.modules))"
    ran = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert ran.stdout.split() == []


def test_the_list_of_commands_says_of_each_what_its_own_help_begins_with() -> None:
    listed = typer.main.get_command(app).commands
    for name, line in SUMMARIES.items():
        assert " ".join(loaded(listed[name]).help.split("\n\n")[0].split()) == line


COMPILER = {"torch._dynamo", "sympy"}  # loaded by the optimisers of PyTorch
STATISTICS = {"scipy.stats", "sklearn", "pandas", "matplotlib"}  # one ink clusters no colours


@pytest.mark.parametrize(
    ("words", "idle"),
    [([], COMPILER), (["--style", "loops", "--ink", "black"], COMPILER | STATISTICS)],
    ids=["free", "loops"],
)
def test_a_plan_ends_without_what_takes_as_long_to_load_as_to_plan(
    words: list[str], idle: set[str], tmp_path: Path
) -> None:
    asked = ["plan", "--demo", "--strokes", "20", "--steps", "2", "--px", "64", "--out", str(tmp_path / "out"), *words]
    script = "import sys, maulstick.cli; maulstick.cli.main()"
    told = "import atexit, sys; atexit.register(lambda: print('loaded', *sys.modules, file=sys.stderr))"
    ran = subprocess.run(
        [sys.executable, "-c", f"{told}; {script}", *asked], capture_output=True, text=True, check=True
    )
    loaded = set(ran.stderr.splitlines()[-1].split())
    assert {"loaded", "torch", "maulstick.planning.planner"} <= loaded
    assert not loaded & idle


def test_a_style_is_learned_without_statistics_that_take_a_second_to_load(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path))
    ink = tmp_path / "me.ink.npz"
    write_ink(Ink.of(list(np.random.default_rng(0).random((6, 9, 4)).cumsum(axis=1) / 10), (2.0, 2.0)), ink)
    modules = loaded_by("style", "fit", str(ink), "--name", "me")
    assert "maulstick.style.exemplar" in modules
    assert "scipy.stats" not in modules
