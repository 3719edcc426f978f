"""Whether each kind of a hand's strokes stays of its kind: cusps and loops that the hand never made there.

Two figures. *Worst kind*: a sheet's own strokes are put into four kinds (Ward's clustering of their descriptions), each
stroke that was drawn after it goes to the kind of the nearest, and is *awry* where it has more cusps or crosses itself
more often than any of that kind; the share of the worst kind that has at least three of the hand's strokes. *Seven
curls*: a hand of the seven curls that are most alike in a session, among thirteen other strokes of it; the share that
is awry of what was drawn like the curls. By people: the rest of the session in the former, each curl
against the six others in the latter.
"""

import numpy as np
from few_shot import Few, Session, paths_of
from numpy.typing import NDArray
from scipy.cluster.hierarchy import fcluster, linkage
from scipy.spatial.distance import cdist

from maulstick.strokes.strokes import Strokes
from maulstick.style.compare import describe

Floats = NDArray[np.float64]
Counts = NDArray[np.int64]

KINDS = 4
FEWEST_OWN, FEWEST_DRAWN = 3, 8
CURLS, AMONG = 7, 13
_CUSP = 2.0  # radians that three joints turn by together, of 30 along a stroke
_CURL, _ONE_WAY = 3.5, 0.6  # radians that a curl turns by at least, and the share of its turning that goes one way
_APART = 1.5  # times as far as the seventh curl: what is nearer is a curl too, and not among the others
_TURNING, _TURN = 2, 3  # columns of a description


def cusps(paths: Floats) -> Counts:
    """Sharp corners of each path (N, n, 2), (N,)."""
    steps = np.diff(paths, axis=1)
    heading = np.unwrap(np.arctan2(steps[..., 1], steps[..., 0]), axis=1)
    sharp = np.abs(heading[:, 3:] - heading[:, :-3]) > _CUSP
    begins: Counts = sharp[:, 0] + (sharp[:, 1:] & ~sharp[:, :-1]).sum(axis=1)
    return begins


def crossings(paths: Floats) -> Counts:
    """How often each path (N, n, 2) crosses itself, (N,)."""
    begin, along = paths[:, :-1], np.diff(paths, axis=1)
    i, j = np.triu_indices(along.shape[1], 2)

    def side(of: Counts, point: Floats) -> Floats:
        """On which side of segments `of` points lie."""
        off = point - begin[:, of]
        sides: Floats = along[:, of, 0] * off[..., 1] - along[:, of, 1] * off[..., 0]
        return sides

    apart = side(i, begin[:, j]) * side(i, paths[:, j + 1]) < 0
    crossed: Counts = (apart & (side(j, begin[:, i]) * side(j, paths[:, i + 1]) < 0)).sum(axis=1)
    return crossed


def awry(drawn: Floats, own: Floats) -> NDArray[np.bool_]:
    """Which of the paths drawn have more cusps or crossings than any of these own ones."""
    more: NDArray[np.bool_] = (cusps(drawn) > cusps(own).max()) | (crossings(drawn) > crossings(own).max())
    return more


def worst_kind(few: Few, drawn: Floats) -> float | None:
    """Share of strokes awry in the worst kind of the twenty's; None where no kind has enough strokes."""
    seen = few.session.describe(few.paths)
    kinds = fcluster(linkage(seen, "ward"), KINDS, "maxclust")
    like = kinds[cdist(few.session.describe(drawn), seen).argmin(axis=1)]
    shares = [
        float(awry(drawn[like == kind], few.paths[kinds == kind]).mean())
        for kind in np.unique(kinds)
        if (kinds == kind).sum() >= FEWEST_OWN and (like == kind).sum() >= FEWEST_DRAWN
    ]
    return max(shares, default=None)


def seven_curls(session: Session, seed: int) -> Strokes | None:
    """Seven like curls of a session, and then thirteen other strokes; None where it has not as many."""
    paths = paths_of(session.strokes)
    described = describe(paths)
    turn = np.abs(described[:, _TURN])
    curls = np.flatnonzero((cusps(paths) == 0) & (turn > _CURL) & (turn > _ONE_WAY * described[:, _TURNING]))
    if len(curls) < CURLS:
        return None
    apart = cdist(*2 * [session.describe(paths[curls])])
    reach = np.sort(apart, axis=1)[:, CURLS - 1]
    middle = int(reach.argmin())
    alike = curls[apart[middle] < _APART * reach[middle]]
    others = np.setdiff1d(np.arange(len(paths)), alike)
    if len(others) < AMONG:
        return None
    chosen = np.concatenate(
        [curls[np.argsort(apart[middle])[:CURLS]], np.random.default_rng(seed).choice(others, AMONG, replace=False)]
    )
    return session.strokes[chosen]


def curls_awry(session: Session, strokes: Strokes, drawn: Floats) -> float:
    """Share awry of the strokes drawn (N, 32, 2) that are most like one of the first seven strokes."""
    own = paths_of(strokes)
    like = cdist(session.describe(drawn), session.describe(own)).argmin(axis=1) < CURLS
    return float(awry(drawn[like], own[:CURLS]).mean()) if like.any() else 0.0


def curls_by_hand(strokes: Strokes) -> float:
    """Share of the first seven strokes that are awry beside the six others."""
    own = paths_of(strokes)[:CURLS]
    return float(np.mean([awry(own[[i]], np.delete(own, i, axis=0))[0] for i in range(CURLS)]))
