"""Run docs/notebook.ipynb, and keep what its cells show, small: pictures as JPEG, and of progress the last line.

.venv/bin/python experiments/notebook.py
"""

import argparse
import io
from base64 import b64decode, b64encode
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import nbformat
from nbclient import NotebookClient
from PIL import Image

NOTEBOOK = Path(__file__).resolve().parents[1] / "docs" / "notebook.ipynb"
LARGEST, QUALITY = 420, 80
"""Pixels of a kept picture, and quality of its JPEG."""


def run(path: Path) -> Any:
    """Run a notebook in an empty folder; returns it with its outputs. Raises CellExecutionError where a cell fails."""
    notebook = nbformat.read(path, as_version=4)
    with TemporaryDirectory() as folder:
        client = NotebookClient(notebook, resources={"metadata": {"path": folder}}, record_timing=False, timeout=300)
        return client.execute()


def small(outputs: list[Any]) -> list[Any]:
    """Outputs of a cell, without what takes much room and shows nothing."""
    said = "".join(output["text"] for output in outputs if output.output_type == "stream")
    last = [line.rpartition("\r")[2] for line in said.split("\n")]
    kept = [nbformat.v4.new_output("stream", name="stdout", text="\n".join(last))] if said else []
    for output in outputs:
        if output.output_type == "execute_result":
            picture = output.data.get("image/png")
            kept.append(output)
            if picture is not None:
                output["data"] = {"image/jpeg": _jpeg(picture), "text/plain": output.data["text/plain"]}
    return kept


def _jpeg(picture: str) -> str:
    with Image.open(io.BytesIO(b64decode(picture))) as image:
        shown = image.convert("RGB")
    shown.thumbnail((LARGEST, LARGEST))
    with io.BytesIO() as file:
        shown.save(file, "JPEG", quality=QUALITY)
        return b64encode(file.getvalue()).decode()


def main() -> None:
    """Run it, and write it with its outputs."""
    argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter).parse_args()
    notebook = run(NOTEBOOK)
    for cell in notebook.cells:
        if cell.cell_type == "code":
            cell["outputs"] = small(cell.outputs)
    nbformat.write(notebook, NOTEBOOK)


if __name__ == "__main__":
    main()
