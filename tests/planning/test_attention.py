import numpy as np
import pytest
from skimage.data import astronaut, coffee

from maulstick.planning.attention import attention, find_faces

PORTRAIT = astronaut()[:400].astype(np.float32) / 255


def test_a_face_counts_more_than_its_surroundings() -> None:
    weights = attention(400, 512, find_faces(PORTRAIT))
    face, flag = weights[60:160, 190:260], weights[200:400, :60]
    assert face.mean() > 3 * flag.mean()
    assert weights.mean() == pytest.approx(1)


@pytest.mark.parametrize("picture", [coffee(), np.zeros((1, 90, 3)), np.zeros((2000, 2, 3))])
def test_a_picture_without_a_face_counts_evenly(picture: np.ndarray) -> None:
    assert (attention(*picture.shape[:2], find_faces(picture.astype(np.float32) / 255)) == 1).all()


def test_a_face_that_is_not_to_count_more_counts_as_its_surroundings() -> None:
    assert (attention(400, 512, find_faces(PORTRAIT), faces=0.0) == 1).all()


def test_a_face_counts_the_more_the_larger_its_weight() -> None:
    least, most = (attention(400, 512, find_faces(PORTRAIT), faces=faces) for faces in (1.0, 2.0))
    assert least.max() / least.min() == pytest.approx(4)
    assert most.max() / most.min() == pytest.approx(7)


def test_a_face_is_found_where_it_is() -> None:
    (face,) = find_faces(astronaut().astype(np.float32) / 255)
    assert (face.x, face.y) == pytest.approx((224, 114), abs=12)
    assert 35 < face.radius < 70
