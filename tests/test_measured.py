"""The tables in the README and in docs are those of the rows that were kept."""

import importlib.util
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
    assert set(paper.COMMANDS) == {path.stem for path in (ROOT / "measured").glob("*.jsonl")}


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
