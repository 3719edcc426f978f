"""For all tests.

With MAULSTICK_NO_SKIPS=1, as on the machine that decides (.ci/run), a skipped test has failed.
With MAULSTICK_BASELINE=1, as in `make test-baseline`, all is computed by the oldest instructions.
"""

import os
import platform
import signal
from collections.abc import Generator
from typing import TypeVar

import pytest
import torch
from hypothesis import settings
from numpy._core._multiarray_umath import __cpu_dispatch__, __cpu_features__
from threadpoolctl import threadpool_info

# Workers, and the processes that they start, share the cores: with more threads than cores each waits for the others.
if "PYTEST_XDIST_WORKER" in os.environ and "OMP_NUM_THREADS" not in os.environ:
    torch.set_num_threads(max(1, len(os.sched_getaffinity(0)) // int(os.environ["PYTEST_XDIST_WORKER_COUNT"])))
    os.environ["OMP_NUM_THREADS"] = str(torch.get_num_threads())

from maulstick.rendering.kernels import cpu  # it has as many threads as torch has when it is imported

# Data that is measured with and never shipped (../shared/data): the one thing that no machine can install.
MAY_BE_ABSENT = "shared data absent"

Report = TypeVar("Report", pytest.TestReport, pytest.CollectReport)

if not torch.cuda.is_available():  # read when Triton is imported, which any test may do first
    os.environ["TRITON_INTERPRET"] = "1"

settings.register_profile("untimed", deadline=None)  # a busy machine is no fault
settings.load_profile("untimed")


def _skips_fail(report: Report) -> Report:
    # An expected failure is reported as skipped too, but brings a traceback where a skip has (path, line, reason).
    if report.skipped and isinstance(report.longrepr, tuple) and os.environ.get("MAULSTICK_NO_SKIPS") == "1":
        reason = report.longrepr[2]
        if MAY_BE_ABSENT not in reason:
            report.outcome = "failed"
            report.longrepr = f"{report.nodeid} was skipped where nothing may be: {reason}"
    return report


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport() -> Generator[None, pytest.TestReport, pytest.TestReport]:
    """Fail a test that skips itself, in its body or by a mark."""
    return _skips_fail((yield))


@pytest.hookimpl(wrapper=True)
def pytest_make_collect_report() -> Generator[None, pytest.CollectReport, pytest.CollectReport]:
    """Fail a file that skips itself while it is read, as pytest.importorskip does."""
    return _skips_fail((yield))


@pytest.fixture(scope="session", autouse=True)
def _nobodys_data(tmp_path_factory: pytest.TempPathFactory) -> Generator[None]:
    """Keep the styles and brushes of whoever runs the tests out of them."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("XDG_DATA_HOME", str(tmp_path_factory.mktemp("data")))
        yield


@pytest.fixture(scope="session", autouse=True)
def _hears_ctrl_c() -> Generator[None]:
    """Ctrl-C arrives here and in the processes that tests start, even if all this was started by ``nohup … &``.

    A shell without job control ignores it for what runs in its background, and a process inherits what is ignored.
    """
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


@pytest.fixture(scope="session", autouse=True)
def _as_another_processor() -> Generator[None]:
    """With MAULSTICK_BASELINE=1 our kernels use their oldest instructions; the libraries were told to, and do."""
    with pytest.MonkeyPatch.context() as patch:
        if os.environ.get("MAULSTICK_BASELINE") == "1":
            for draw in (cpu.darkness, cpu.composite):
                patch.setitem(draw.__kwdefaults__, "instructions", cpu.INSTRUCTION_SETS[-1])
            assert torch.backends.cpu.get_cpu_capability() == "DEFAULT"
            assert not [name for name in __cpu_dispatch__ if __cpu_features__[name]], "NumPy"
            if platform.machine() == "x86_64":
                blas = {library["architecture"] for library in threadpool_info() if library["user_api"] == "blas"}
                assert blas == {"Nehalem"}
        yield
