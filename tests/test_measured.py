"""The tables in the README and in docs are those of the rows that were kept."""

import importlib.util
import subprocess
import sys
from pathlib import Path
from types import ModuleType

import pytest

ROOT = Path(__file__).resolve().parents[1]


@pytest.fixture
def paper(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    monkeypatch.syspath_prepend(str(ROOT / "benchmarks"))
    spec = importlib.util.spec_from_file_location("paper_tables", ROOT / "benchmarks" / "paper.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    monkeypatch.setitem(sys.modules, "paper_tables", module)
    spec.loader.exec_module(module)
    return module


def test_every_table_in_the_readme_and_in_docs_is_as_it_was_measured(paper: ModuleType) -> None:
    assert {*paper.DOCUMENTS} == {ROOT / "README.md", *(ROOT / "docs").glob("*.md")}
    marked = []
    for document in paper.DOCUMENTS:
        text = document.read_text(encoding="utf-8")
        assert paper.filled(text) == text, f"{document.name}: run benchmarks/paper.py --tables"
        marked += [found[2] for found in paper.MARKED.finditer(text)]
    assert set(marked) == set(paper.TABLES)
    assert set(paper.COMMANDS) == {path.stem for path in (ROOT / "measured").glob("*.jsonl")} == set(paper.commits())


def test_a_table_whose_figure_was_changed_by_hand_is_found(paper: ModuleType) -> None:
    text = (ROOT / "docs" / "measured.md").read_text(encoding="utf-8")
    assert paper.filled(text.replace(" dB", "9 dB")) == text


def test_rows_stay_as_they_were_where_their_benchmark_fails(
    paper: ModuleType, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    kept = tmp_path / "measured" / "plan.jsonl"
    kept.parent.mkdir()
    kept.write_text("kept", encoding="utf-8")
    monkeypatch.setattr(paper, "ROOT", tmp_path)
    monkeypatch.setitem(paper.COMMANDS, "plan", ["-c", "print('half a row'); raise SystemExit('no data')"])
    with pytest.raises(SystemExit, match="plan is kept as it was"):
        paper.measure("plan")
    assert kept.read_text(encoding="utf-8") == "kept"


def test_rows_are_kept_with_the_commit_of_the_code_that_they_were_measured_with(
    paper: ModuleType, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    kept = tmp_path / "measured"
    kept.mkdir()
    (kept / "commits.json").write_text('{"plan": "0000000", "steps": "1111111"}', encoding="utf-8")
    code = tmp_path / "bench.py"
    code.write_text("print('a row')", encoding="utf-8")
    for asked in (
        ["init", "-q"],
        ["add", "bench.py"],
        ["-c", "user.name=a", "-c", "user.email=b", "commit", "-qm", "c"],
    ):
        subprocess.run(["git", "-C", tmp_path, *asked], check=True)
    head = subprocess.run(["git", "-C", tmp_path, "rev-parse", "HEAD"], check=True, capture_output=True, text=True)
    for module in (paper, sys.modules["kept"]):
        monkeypatch.setattr(module, "ROOT", tmp_path)
    monkeypatch.setitem(paper.COMMANDS, "plan", ["bench.py"])
    paper.measure("plan")
    assert paper.commits() == {"plan": head.stdout[:7], "steps": "1111111"}
    code.write_text("print('another row')", encoding="utf-8")
    paper.measure("plan")
    assert paper.commits()["plan"] == f"{head.stdout[:7]}+"
    assert (kept / "plan.jsonl").read_text(encoding="utf-8") == "another row\n"
