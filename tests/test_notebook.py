"""The notebook runs from its first cell to its last, and keeps small outputs."""

import os
import runpy
from pathlib import Path

import nbformat
import pytest

from tests.support.pages import DOCS, ROOT

NOTEBOOK = DOCS / "notebook.ipynb"
HEAVIEST = 600_000  # bytes


@pytest.fixture(autouse=True)
def _own_files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Nothing of whoever runs the tests is read by Jupyter, or written."""
    for name in ("IPYTHONDIR", "JUPYTER_CONFIG_DIR", "JUPYTER_RUNTIME_DIR"):
        monkeypatch.setenv(name, str(tmp_path / name))


@pytest.mark.filterwarnings("ignore::DeprecationWarning:(jupyter|zmq|nbclient|traitlets)")
def test_every_cell_runs_and_shows_what_it_did() -> None:
    run = runpy.run_path(str(ROOT / "experiments" / "notebook.py"))["run"]
    cells = [cell for cell in run(NOTEBOOK).cells if cell.cell_type == "code"]
    pictures = [output for cell in cells for output in cell.outputs if "image/png" in output.get("data", {})]
    assert len(pictures) == 4
    assert "strokes are on the sheet" in "".join(output.get("text", "") for output in cells[-1].outputs)


def test_it_was_run_in_order_and_is_small() -> None:
    cells = [cell for cell in nbformat.read(NOTEBOOK, as_version=4).cells if cell.cell_type == "code"]
    assert [cell.execution_count for cell in cells] == list(range(1, len(cells) + 1))
    assert sum(bool(cell.outputs) for cell in cells) >= len(cells) - 1
    assert os.path.getsize(NOTEBOOK) < HEAVIEST
