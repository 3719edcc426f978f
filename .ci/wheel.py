"""Build the sdist and out of it the wheel, and try that as strangers do: in an empty environment, without a compiler.

    .venv/bin/python .ci/wheel.py [--keep FOLDER | --wheel FILE]

Twice: with PyTorch it plans, exports and paints; without, it exports and paints, and says what planning needs. Nothing
but the wheel is installed there: what it requires, and what that requires, is linked from .venv, so that whatever it
forgets to require is missing. Python 3.11 makes a wheel for 3.11 alone, and 3.12 one for all from 3.12 on.

--keep: folder that the sdist and the wheel are copied to.  --wheel: a wheel that was built before, to be tried.
"""

import argparse
import os
import shutil
import subprocess
import sys
from collections.abc import Iterator
from importlib.metadata import Distribution, distribution, distributions
from pathlib import Path
from tempfile import TemporaryDirectory
from venv import EnvBuilder

from packaging.requirements import Requirement

ROOT = Path(__file__).resolve().parents[1]
CONSTRAINTS = ROOT / "constraints.txt"
COMPILERS = ("cc", "c++", "gcc", "g++", "clang", "clang++", "cl", "cmake", "ninja")
STABLE = (3, 12)  # the oldest Python whose stable interface nanobind can use


def main() -> None:
    """Build and try; any command that fails ends the script with its output."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--keep", type=Path)
    parser.add_argument("--wheel", type=Path)
    arguments = parser.parse_args()
    with TemporaryDirectory() as folder:
        built = (arguments.keep or Path(folder, "built")).absolute()
        wheel = build(built) if arguments.wheel is None else arguments.wheel.absolute()
        print(f"{wheel.name}: {wheel.stat().st_size / 1e6:.1f} MB", flush=True)
        plan_export_and_paint(Environment(Path(folder, "whole"), wheel, "plan"), Path(folder))
        export_and_paint_alone(Environment(Path(folder, "small"), wheel, None), Path(folder))


def build(folder: Path) -> Path:
    """Build an sdist and out of it a wheel into `folder`, and return the wheel, whose tag is looked at."""
    environment = {**os.environ, "PIP_CONSTRAINT": str(CONSTRAINTS), "PIP_DISABLE_PIP_VERSION_CHECK": "1"}
    run([sys.executable, "-m", "build", "--outdir", str(folder), str(ROOT)], environment, ROOT)
    wheel = max(folder.glob("*.whl"), key=lambda path: path.stat().st_mtime)
    tag = "cp312-abi3" if sys.version_info >= STABLE else f"cp3{sys.version_info.minor}-cp3{sys.version_info.minor}"
    if f"-{tag}-" not in wheel.name:
        raise SystemExit(f"{wheel.name} is not tagged {tag}")
    return wheel


class Environment:
    """Environment with the wheel, what it requires, and nothing else: none of its commands finds a compiler."""

    def __init__(self, folder: Path, wheel: Path, extra: str | None) -> None:
        EnvBuilder().create(folder)
        self.bin = folder / "bin"
        self._variables = {"PATH": str(self.bin), "HOME": str(folder), "LANG": "C.UTF-8"}
        (packages,) = folder.glob("lib/python3*/site-packages")
        required = dict[str, Distribution]()
        for requirement in _requirements(_of_wheel(wheel), {extra or ""}):
            _collect(requirement, required)
        for each in required.values():
            _link(each, packages)
        asked = str(wheel) if extra is None else f"{wheel}[{extra}]"
        pip = [sys.executable, "-m", "pip", "--python", str(self.bin / "python"), "install", "--quiet", "--no-index"]
        run([*pip, "--constraint", str(CONSTRAINTS), asked], self._variables, folder)
        for compiler in COMPILERS:
            if shutil.which(compiler, path=self._variables["PATH"]) is not None:
                raise SystemExit(f"{compiler} can be found in {self.bin}")

    def run(self, folder: Path, *words: str, code: int = 0) -> str:
        """Run a command of the environment in `folder`, and return what it says, once it has left with `code`."""
        return run([str(self.bin / words[0]), *words[1:]], self._variables, folder, code)


def plan_export_and_paint(environment: Environment, folder: Path) -> None:
    """Plan the portrait that comes along, write it for a plotter, and paint it on the simulated easel."""
    where = environment.run(folder, "python", "-c", "import maulstick; print(maulstick.__file__)")
    if not where.startswith(str(environment.bin.parent)):
        raise SystemExit(f"not the wheel is tried, but {where}")
    asked = ("--strokes", "20", "--steps", "20", "--pressure", "0.5", "--out", "portrait")
    environment.run(folder, "maulstick", "plan", "--demo", *asked)
    environment.run(folder, "maulstick", "export", "portrait/painting.json", "--format", "gcode")
    environment.run(folder, "maulstick", "paint", "portrait/painting.json")
    print("with PyTorch: planned, exported and painted", flush=True)


def export_and_paint_alone(environment: Environment, folder: Path) -> None:
    """Write and paint the portrait where there is no PyTorch, and see that planning says what it needs."""
    environment.run(folder, "maulstick", "export", "portrait/painting.json", "--format", "hpgl")
    environment.run(folder, "maulstick", "paint", "portrait/painting.json", "--restart")
    said = environment.run(folder, "maulstick", "plan", "--demo", "--out", "other", code=2)
    if "WHEEL[plan]" not in said:
        raise SystemExit(f"planning without PyTorch says: {said}")
    print("without PyTorch: exported and painted", flush=True)


def run(command: list[str], variables: dict[str, str], folder: Path, code: int = 0) -> str:
    """Run a command, and return what it says; where it leaves with another code, end with all of that."""
    ran = subprocess.run(
        command, env=variables, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
    )
    if ran.returncode != code:
        raise SystemExit(f"{ran.stdout}\n{' '.join(command)} left with {ran.returncode}, not {code}")
    return ran.stdout


def _of_wheel(wheel: Path) -> Distribution:
    (found,) = distributions(name="maulstick", path=[str(wheel)])
    return found


def _requirements(of: Distribution, extras: set[str]) -> Iterator[Requirement]:
    for text in of.requires or []:
        requirement = Requirement(text)
        marker = requirement.marker
        if marker is None or any(marker.evaluate({"extra": extra}) for extra in extras or {""}):
            yield requirement


def _collect(requirement: Requirement, required: dict[str, Distribution]) -> None:
    """Add the distribution that fulfils a requirement, and all that this one requires, to those `required`."""
    key = str(requirement)
    if key not in required:
        required[key] = distribution(requirement.name)
        for each in _requirements(required[key], {"", *requirement.extras}):
            _collect(each, required)


def _link(installed: Distribution, packages: Path) -> None:
    for name in {file.parts[0] for file in installed.files or []} - {"..", "__pycache__"}:
        if not (packages / name).exists():
            (packages / name).symlink_to(Path(str(installed.locate_file(name))))


if __name__ == "__main__":
    main()
