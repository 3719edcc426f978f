"""Pages that are closed leave nothing in the server."""

import json
import subprocess
import sys
from pathlib import Path

LOADS = 14  # two of each panel
MOST_KEPT = (
    50_000  # bytes per load: what a page is made of takes 150,000 at least, and what Python keeps by itself 5,000
)


def test_pages_that_were_closed_are_gone_from_memory(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "tests.support.studio.page_loads", str(tmp_path / "studio"), str(LOADS)]
    told = subprocess.run(command, capture_output=True, text=True, timeout=300, check=True).stdout
    found = json.loads(told.splitlines()[-1])
    assert found["clients"] == [0, 0]
    assert found["subscriptions"][0] == found["subscriptions"][1]
    assert found["kept"] < MOST_KEPT
