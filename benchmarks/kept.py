"""Rows that were kept of a measurement, and Markdown made of them."""

import json
import sys
from argparse import ArgumentTypeError
from pathlib import Path
from typing import Any

import numpy as np

ROOT = Path(__file__).resolve().parents[1]
Row = dict[str, Any]


def python_of(checkout: Path) -> str:
    """The interpreter that runs a checkout: this one's own is the running one."""
    return sys.executable if checkout == ROOT else str(checkout / ".venv" / "bin" / "python")


def checkout_named(path: str) -> Path:
    """The checkout in a folder, for argparse."""
    checkout = Path(path).resolve()
    if not Path(python_of(checkout)).is_file():
        raise ArgumentTypeError(f"{path} is no checkout with a .venv; name the folder of one")
    return checkout


def rows_of(name: str) -> list[Row]:
    """The rows that were kept."""
    return [json.loads(line) for line in (ROOT / "measured" / f"{name}.jsonl").read_text(encoding="utf-8").splitlines()]


def commits() -> dict[str, str]:
    """By the name of kept rows, the commit of the code that they were measured with."""
    found: dict[str, str] = json.loads((ROOT / "measured" / "commits.json").read_text(encoding="utf-8"))
    return found


def rows_of_others(name: str) -> list[Row]:
    """The rows that were kept of other checkouts, which may be gone."""
    return [row for row in rows_of(name) if row["source"] != "here"]


def with_range(values: list[float], digits: int) -> str:
    """Their mean, the least and the most."""
    return f"{np.mean(values):.{digits}f} ({min(values):.{digits}f} to {max(values):.{digits}f})"


def with_interval(value: float, ends: list[float], digits: int = 2) -> str:
    """A figure and the ends of its interval."""
    return f"{value:.{digits}f} ({ends[0]:.{digits}f} to {ends[1]:.{digits}f})"


def table(head: list[str], lines: list[list[str]]) -> str:
    """A table in Markdown."""
    return "".join(f"| {' | '.join(line)} |\n" for line in (head, ["---"] * len(head), *lines))


def table_of(rows: list[Row], columns: dict[str, str]) -> str:
    """A table with a line for each row; columns: how a row's figures are written, by title."""
    return table(list(columns), [[written.format(**row) for written in columns.values()] for row in rows])
