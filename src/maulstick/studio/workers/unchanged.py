"""Check that a plan goes on with what it began with, so that no painting is half of one picture and half of another."""

import json
from pathlib import Path

from maulstick.errors import InputError
from maulstick.jobs.plan.request import PlanRequest, state_files
from maulstick.storage.files import atomic_write

_SUMS = "sums.json"  # in a plan's folder


def check_or_keep_sums(request: PlanRequest, folder: Path, is_begun: bool) -> None:
    """Compare the sums of what a plan is made with to those that its folder keeps; before it is begun, keep them.

    request: with its sums, as `prepare` returns it.  is_begun: whether a try of it is over already.
    Raises InputError where a file, the brush or the style has changed since.
    """
    sums, kept = _named(request), folder / _SUMS
    if not is_begun and not state_files(folder):
        atomic_write(kept, json.dumps(sums).encode())
        return
    if not kept.is_file():  # an earlier Maulstick kept none
        return
    for name, was in json.loads(kept.read_bytes()).items():
        if sums.get(name) != was:
            raise InputError(f"{name} has changed since planning began; put it back, or “Plan again like this”")


def _named(request: PlanRequest) -> dict[str, str]:
    """Return the sums of a request, those of files by what they are for: a studio's folder may be moved."""
    options = request.options
    files = {
        "the picture": request.picture,
        "the picture whose look it has": options.look,
        "the photograph of the sheet": options.background,
        "the list of your tubes": options.paints_from,
        "the file of the network": options.clip_weights,
        "the painting that it is planned around": options.again,
        "the map of its regions": options.regions,
        "what is said of its regions": options.say,
        "the file of its guides": options.guides,
    }
    names = {str(path): name for name, path in files.items()}
    return {names.get(path, path): value for path, value in request.sums.items()}
