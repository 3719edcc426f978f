"""Words for what differs between a version and the plan that it came from."""

from collections.abc import Mapping

from maulstick.jobs.plan.region_descriptions import ALONG_GUIDES
from maulstick.storage.text import counted
from maulstick.studio.workers.said import Said, SaidRegion
from maulstick.studio.workers.stroke_changes import StrokeChanges


def version_in_words(strokes: StrokeChanges, before: Said, now: Said, hands: Mapping[str, str], done: str) -> str:
    """Return a sentence on what a person has changed. hands: titles of styles by name.  done: what was done then."""
    said = "; ".join([*_of_strokes(strokes), *_of_places(before, now, hands), done])
    return f"{said[0].upper()}{said[1:]}."


def region_in_words(region: SaidRegion, hands: Mapping[str, str]) -> str:
    """Return a region with what holds there: ``a region “face” in loops, counts 3 times``."""
    if region.bare:
        return f"bare paper “{region.name}”"
    said = [
        f"a region “{region.name}”" + ("" if region.style is None else f" in {hands.get(region.style, region.style)}")
    ]
    if region.hand_size is not None:
        said.append(f"{region.hand_size:g} times the size")
    if region.brush is not None:
        said.append(f"with {' and '.join(region.brush.split(','))}")
    if region.importance != 1:
        said.append(f"counts {region.importance:g} times")
    if region.direction is not None:
        said.append("along the guides" if region.direction == ALONG_GUIDES else f"at {region.direction:g}°")
    if region.soft:
        said.append(f"soft over {1e3 * region.soft:g} mm")
    return ", ".join(said)


def _of_strokes(strokes: StrokeChanges) -> list[str]:
    acts = {
        "locked": strokes.locked,
        "unlocked": strokes.unlocked,
        "taken out": strokes.removed,
        "drawn": strokes.drawn,
        "moved": strokes.moved,
        "painted otherwise": strokes.repainted,
    }
    (first, many), *others = [each for each in acts.items() if each[1]] or [("", 0)]
    if not many:
        return []
    return [", ".join([f"{counted(many, 'stroke')} {first}", *(f"{count} {act}" for act, count in others)])]


def _of_places(before: Said, now: Said, hands: Mapping[str, str]) -> list[str]:
    kept, guides = {each.id for each in now.regions}, set(now.guides) - set(before.guides)
    said = [region_in_words(region, hands) for region in now.regions if region not in before.regions]
    said += [f"region “{region.name}” taken out" for region in before.regions if region.id not in kept]
    said += [counted(len(guides), "guide")] if guides else []
    gone = set(before.guides) - set(now.guides)
    return said + ([f"{counted(len(gone), 'guide')} taken out"] if gone else [])
