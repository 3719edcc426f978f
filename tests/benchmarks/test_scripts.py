"""Scripts of benchmarks and experiments, as somebody calls them who does not know them yet."""

import runpy
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
RUN_BY_OTHERS = ("franka_clock", "drawn_by_splender")  # in environments that have what they need
SCRIPTS = [
    path
    for folder in ("benchmarks", "experiments")
    for path in sorted((ROOT / folder).glob("*.py"))
    if path.stem not in RUN_BY_OTHERS and '__name__ == "__main__"' in path.read_text(encoding="utf-8")
]


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda path: f"{path.parent.name}/{path.name}")
def test_a_script_says_what_it_does_and_refuses_what_it_does_not_know_before_it_does_anything(
    script: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    text = script.read_text(encoding="utf-8")
    assert "parse_args(" in text, "it would do all that it does"
    monkeypatch.syspath_prepend(str(script.parent))
    for argument, code in (("--help", 0), ("--no-such-option", 2)):
        monkeypatch.setattr(sys, "argv", [str(script), argument])
        with pytest.raises(SystemExit) as left:
            runpy.run_path(str(script), run_name="__main__")
        assert left.value.code == code
    out, err = capsys.readouterr()
    assert text.split('"""')[1].splitlines()[0] in out
    assert "unrecognized arguments: --no-such-option" in err or "required: " in err


@pytest.mark.parametrize(
    ("script", "words", "told"),
    [
        ("faces", ["nobody"], "there is no image nobody; there are: astronaut, grace_hopper"),
        ("steps", ["--beside", "../before"], "'../before' is no CHECKOUT=N; write a folder and a number of steps"),
        ("steps", ["--beside", "/none=500"], "/none is no checkout with a .venv; name the folder of one"),
        ("startup", ["--beside", "/none"], "/none is no checkout with a .venv; name the folder of one"),
        ("plan", ["--step-cost", "--beside", "/none"], "/none is no checkout with a .venv; name the folder of one"),
    ],
)
def test_a_name_that_a_benchmark_does_not_know_ends_with_one_line_before_it_measures_anything(
    script: str, words: list[str], told: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    path = ROOT / "benchmarks" / f"{script}.py"
    monkeypatch.syspath_prepend(str(path.parent))
    monkeypatch.setattr(sys, "argv", [str(path), *words])
    with pytest.raises(SystemExit) as left:
        runpy.run_path(str(path), run_name="__main__")
    out, err = capsys.readouterr()
    assert (left.value.code, out) == (2, "")
    assert told in err.splitlines()[-1]
