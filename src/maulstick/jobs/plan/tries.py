"""Tries of a plan, each from a seed of its own, of which the best is kept."""

from collections.abc import Iterable
from dataclasses import replace

from maulstick.jobs.plan.prepare import prepare
from maulstick.jobs.plan.prepared import Prepared
from maulstick.jobs.plan.request import PlanRequest
from maulstick.painting.painting import Painting


def seeds_of(request: PlanRequest) -> range:
    """Return the seeds of all tries of a request."""
    return range(request.options.seed, request.options.seed + request.tries)


def prepare_try(request: PlanRequest, seed: int) -> Prepared:
    """Return what the try from this seed needs; its file says how many tries there were. Raises as `prepare`."""
    prepared = prepare(replace(request, options=replace(request.options, seed=seed), tries=1))
    options = {**prepared.provenance.options, "tries": request.tries}
    return replace(prepared, provenance=prepared.provenance.model_copy(update={"options": options}))


def best_of(paintings: Iterable[Painting]) -> Painting:
    """Return the painting with the least loss."""
    return min(paintings, key=lambda painting: painting.provenance.metrics["loss"])
