import gc
import subprocess
import sys

import pytest

from maulstick.cli.loading import no_garbage


def test_what_is_loaded_is_never_looked_through_for_garbage_again() -> None:
    script = (
        "import gc, sys; from maulstick.cli.loading import no_garbage; "
        "runs = []; gc.callbacks.append(lambda *_: runs.append(1)); before = gc.get_freeze_count()\n"
        "with no_garbage(): import numpy\n"
        "print(len(runs), gc.isenabled(), before, gc.get_freeze_count() > 10_000)"
    )
    ran = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert ran.stdout.split() == ["0", "True", "0", "True"]


def test_garbage_is_collected_again_after_an_import_that_failed_or_loaded_nothing() -> None:
    frozen = gc.get_freeze_count()
    with pytest.raises(ModuleNotFoundError), no_garbage():
        import nothing_of_this_name  # type: ignore[import-not-found]  # noqa: F401
    assert gc.isenabled()
    assert gc.get_freeze_count() == frozen
