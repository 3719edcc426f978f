import numpy as np
import pytest
from skimage.data import astronaut, coffee

from maulstick.planning.attention import attention


def test_a_face_counts_more_than_its_surroundings() -> None:
    weights = attention(astronaut()[:400].astype(np.float32) / 255)
    face, flag = weights[60:160, 190:260], weights[200:400, :60]
    assert face.mean() > 3 * flag.mean()
    assert weights.mean() == pytest.approx(1)


@pytest.mark.parametrize("picture", [coffee(), np.zeros((1, 90, 3)), np.zeros((2000, 2, 3))])
def test_a_picture_without_a_face_counts_evenly(picture: np.ndarray) -> None:
    assert (attention(picture.astype(np.float32) / 255) == 1).all()
