import numpy as np
import pytest
from sklearn.cluster import KMeans
from threadpoolctl import threadpool_limits

from maulstick.colour.clusters import k_means


@pytest.mark.parametrize("seed", range(8))
@pytest.mark.parametrize(("count", "k"), [(5, 5), (40, 1), (60, 6), (400, 12), (2000, 24)])
def test_the_clusters_are_those_of_scikit_learn(count: int, k: int, seed: int) -> None:
    rng = np.random.default_rng(100 * seed + k)
    points = rng.normal(0, 20, (count, 3)) + 40 * rng.integers(0, 4, (count, 1))
    weights = rng.random(count) ** 2
    with threadpool_limits(1):
        theirs = KMeans(k, n_init=4, random_state=seed).fit(points, sample_weight=weights)
    assert k_means(points, weights, k, 4, seed) == pytest.approx(theirs.cluster_centers_, abs=1e-9)
