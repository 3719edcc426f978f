"""CLIP as open_clip builds, loads and tokenises it, only tiny and with random weights."""

import json
import re
from pathlib import Path
from typing import Any

import open_clip
import pytest
import torch
from open_clip import pretrained
from safetensors.torch import save_file
from torch import Tensor

from maulstick.errors import InputError, how_to_add
from maulstick.planning.features import clip
from maulstick.planning.features.clip import Clip
from tests.support.planning.tiny_network import noise
from tests.support.tolerances import FLOAT32_GRADIENT, FLOAT32_VALUE

TEXT = {"context_length": 77, "vocab_size": 49408, "width": 16, "heads": 2, "layers": 1}
TRANSFORMER = {"image_size": 32, "layers": 3, "width": 16, "head_width": 8, "patch_size": 8}
RESNET = {"image_size": 64, "layers": [1, 1, 1, 1], "width": 8, "head_width": 8, "patch_size": None}
VISION = {"tiny-transformer": TRANSFORMER, "tiny-resnet": RESNET}

models = pytest.mark.parametrize("name", list(VISION))


@pytest.fixture(scope="module")
def weights(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """Files of random weights, by the names of models that open_clip knows from now on."""
    folder = tmp_path_factory.mktemp("clip")
    for name, vision in VISION.items():
        (folder / f"{name}.json").write_text(json.dumps({"embed_dim": 12, "vision_cfg": vision, "text_cfg": TEXT}))
    open_clip.add_model_config(folder)
    files = {name: folder / f"{name}.safetensors" for name in VISION}
    with torch.random.fork_rng():
        torch.manual_seed(0)
        for name, file in files.items():
            model = open_clip.CLIP(12, VISION[name], TEXT)
            for parameter in model.parameters():
                parameter.data += 0.1 * torch.randn_like(parameter)
            save_file(model.state_dict(), file)
    return files


def images(side: int, count: int = 2) -> Tensor:
    return noise(0, count, 3, side, side).float()


def test_a_resnets_features_are_its_four_stages(weights: dict[str, Path]) -> None:
    network = Clip.load("tiny-resnet", weights["tiny-resnet"])
    assert (network.name, network.side) == ("tiny-resnet", 64)
    maps, embedding = network.features(images(64))
    assert [tuple(x.shape) for x in maps] == [(2, 32, 16, 16), (2, 64, 8, 8), (2, 128, 4, 4), (2, 256, 2, 2)]
    assert embedding.shape == (2, 12)
    assert torch.allclose(embedding.norm(dim=1), torch.ones(2))


def test_a_transformers_features_are_maps_of_its_tokens(weights: dict[str, Path]) -> None:
    network = Clip.load("tiny-transformer", weights["tiny-transformer"])
    maps, _ = network.features(images(32))
    assert [tuple(x.shape) for x in maps] == [(2, 16, 4, 4)] * 3
    assert not torch.allclose(maps[0], maps[1])


@models
def test_it_sees_what_open_clip_sees(weights: dict[str, Path], name: str) -> None:
    network = Clip.load(name, weights[name])
    model, _, _ = open_clip.create_model_and_transforms(name, pretrained=str(weights[name]))
    shown = images(network.side)
    mean, std = (torch.tensor(x)[:, None, None] for x in (open_clip.OPENAI_DATASET_MEAN, open_clip.OPENAI_DATASET_STD))
    with torch.no_grad():
        wanted = model.eval().encode_image((shown - mean) / std, normalize=True)
    assert torch.allclose(network.features(shown)[1], wanted, atol=FLOAT32_VALUE)


@models
def test_it_reads_what_open_clip_reads(weights: dict[str, Path], name: str) -> None:
    network = Clip.load(name, weights[name])
    model = open_clip.create_model(name, pretrained=str(weights[name])).eval()
    texts = ["a sailing boat", "a cat " * 100, "Ölkanne"]
    embedded = network.embed_text(texts)
    with torch.no_grad():
        wanted = model.encode_text(open_clip.get_tokenizer(name)(texts), normalize=True)
    assert embedded.shape == (3, 12)
    assert torch.allclose(embedded, wanted, atol=FLOAT32_VALUE)
    assert torch.pdist(embedded).min() > 1e-3
    assert not embedded.requires_grad


@models
def test_only_images_are_differentiated(weights: dict[str, Path], name: str) -> None:
    network = Clip.load(name, weights[name])
    shown = images(network.side)
    maps, embedding = network.features(shown)
    assert not any(x.requires_grad for x in [*maps, embedding])
    shown.requires_grad_()
    maps, embedding = network.features(shown)
    for output in [*maps, embedding[:, 0]]:
        (gradient,) = torch.autograd.grad(output.sum(), shown, retain_graph=True)
        assert gradient.abs().sum() > 0


@models
def test_it_works_in_the_precision_of_its_images(weights: dict[str, Path], name: str) -> None:
    network = Clip.load(name, weights[name])
    single, double = (network.features(images(network.side).to(x)) for x in (torch.float32, torch.float64))
    assert double[1].dtype == double[0][0].dtype == torch.float64
    assert torch.allclose(double[1].float(), single[1], atol=FLOAT32_GRADIENT)


def test_loading_it_draws_no_random_numbers_of_the_program(weights: dict[str, Path]) -> None:
    before = torch.get_rng_state()
    Clip.load("tiny-resnet", weights["tiny-resnet"])
    assert torch.equal(torch.get_rng_state(), before)


def test_layers_are_chosen_by_number(weights: dict[str, Path]) -> None:
    usual, _ = Clip.load("tiny-resnet", weights["tiny-resnet"]).features(images(64))
    chosen, _ = Clip.load("tiny-resnet", weights["tiny-resnet"], layers=(0, 3)).features(images(64))
    assert len(chosen) == 2
    assert tuple(chosen[0].shape) == (2, 8, 16, 16), "the stem"
    assert torch.equal(chosen[1], usual[2])


@pytest.mark.parametrize("layer", [-1, 5])
def test_a_layer_that_there_is_not_is_refused(weights: dict[str, Path], layer: int) -> None:
    sentence = f"the layer of CLIP is {layer}; it must be in 0 to 4 for tiny-resnet"
    with pytest.raises(InputError, match=f"^{sentence}$"):
        Clip.load("tiny-resnet", weights["tiny-resnet"], layers=(1, layer))


def test_weights_are_read_from_a_pickle_of_tensors(weights: dict[str, Path], tmp_path: Path) -> None:
    network = Clip.load("tiny-resnet", weights["tiny-resnet"])
    model = open_clip.create_model("tiny-resnet", pretrained=str(weights["tiny-resnet"]))
    torch.save({"state_dict": model.state_dict()}, tmp_path / "checkpoint.pt")
    other = Clip.load("tiny-resnet", tmp_path / "checkpoint.pt")
    assert torch.equal(other.features(images(64))[1], network.features(images(64))[1])


class Trap:
    def __reduce__(self) -> tuple[Any, tuple[str]]:
        return pytest.fail, ("code out of the file was run",)


def test_a_file_that_could_run_code_is_refused_and_runs_none(weights: dict[str, Path], tmp_path: Path) -> None:
    torch.save({"state_dict": {"x": Trap()}}, tmp_path / "trap.pt")
    with pytest.raises(
        InputError, match="holds more than tensors, and reading it could run what is in it; give"
    ) as refused:
        Clip.load("tiny-resnet", tmp_path / "trap.pt")
    assert "\n" not in str(refused.value)


def test_a_torchscript_archive_is_refused(weights: dict[str, Path], tmp_path: Path) -> None:
    with pytest.warns(FutureWarning, match="deprecated"):
        torch.jit.trace(torch.nn.Linear(2, 2), torch.zeros(1, 2)).save(tmp_path / "RN101.pt")
    with pytest.raises(InputError, match=r"RN101.pt holds more than tensors"):
        Clip.load("tiny-resnet", tmp_path / "RN101.pt")


def test_weights_of_another_model_are_refused_in_one_line(weights: dict[str, Path]) -> None:
    with pytest.raises(InputError, match=r"tiny-transformer.safetensors gives no tiny-resnet: ") as refused:
        Clip.load("tiny-resnet", weights["tiny-transformer"])
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize("content", [b"\x08\x00\x00\x00\x00\x00\x00\x00{broken!", b"not weights at all"])
@pytest.mark.parametrize("suffix", [".safetensors", ".pt"])
def test_a_broken_file_is_refused_in_one_line(
    weights: dict[str, Path], tmp_path: Path, suffix: str, content: bytes
) -> None:
    broken = (tmp_path / "broken").with_suffix(suffix)
    broken.write_bytes(content)
    with pytest.raises(InputError, match=r"broken\.(safetensors|pt) (gives no|holds more)") as refused:
        Clip.load("tiny-resnet", broken)
    assert "\n" not in str(refused.value)


def test_a_file_of_another_kind_is_refused(weights: dict[str, Path], tmp_path: Path) -> None:
    (tmp_path / "weights.npz").write_bytes(b"PK")
    with pytest.raises(InputError, match=r"is no file of CLIP weights; it must be one of: .safetensors, .pt"):
        Clip.load("tiny-resnet", tmp_path / "weights.npz")
    with pytest.raises(InputError, match="absent"):
        Clip.load("tiny-resnet", tmp_path / "absent.safetensors")


def test_a_model_that_there_is_not_is_refused_with_the_usual_ones() -> None:
    with pytest.raises(InputError, match=r"there is no CLIP model 'RN7'; usual ones are RN50, RN101, .* lists all \d+"):
        Clip.load("RN7")


def test_the_usual_models_exist_with_the_usual_weights() -> None:
    for name in clip.USUAL:
        assert "openai" in open_clip.list_pretrained_tags_by_model(name)


def test_weights_that_there_are_not_are_refused_with_those_that_there_are() -> None:
    with pytest.raises(InputError, match="there is no set of weights for RN101 'best'; there are: openai, yfcc15m"):
        Clip.load("RN101:best")


def test_a_model_without_published_weights_needs_a_file(weights: dict[str, Path]) -> None:
    text = r"nobody publishes weights of tiny-resnet; give a file of them with clip_weights$"
    with pytest.raises(InputError, match=text):
        Clip.load("tiny-resnet")


def test_without_a_network_a_file_is_asked_for(monkeypatch: pytest.MonkeyPatch) -> None:
    def unreachable(made: dict[str, Any]) -> str:
        raise ConnectionError("no route\nto host")

    monkeypatch.setattr(open_clip, "download_pretrained", unreachable)
    sentence = (
        "the openai weights of ViT-B-32 are not on this machine and cannot be fetched; "
        "give a file of them with clip_weights, or try again with a network"
    )
    with pytest.raises(InputError, match=f"^{sentence}$"):
        Clip.load("ViT-B/32")


def test_without_the_package_it_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(clip, "find_spec", lambda name: None)
    with pytest.raises(InputError, match=rf"^CLIP needs the package open-clip-torch; {re.escape(how_to_add('clip'))}$"):
        Clip.load()


def test_published_weights_are_used_as_they_were_trained(
    weights: dict[str, Path], monkeypatch: pytest.MonkeyPatch
) -> None:
    name = "tiny-transformer"
    published = {
        tag: {"file": str(weights[name]), "quick_gelu": tag == "openai", "mean": (0.5,) * 3, "std": (0.5,) * 3}
        for tag in ("laion", "openai")
    }
    monkeypatch.setitem(pretrained._PRETRAINED, name, published)
    by_default, approximate, exact = (Clip.load(x) for x in (name, f"{name}:openai", f"{name}:laion"))
    model = open_clip.create_model(name, pretrained=str(weights[name]), force_quick_gelu=True).eval()
    shown = images(32)
    with torch.no_grad():
        wanted = model.encode_image((shown - 0.5) / 0.5, normalize=True)
    assert torch.allclose(by_default.features(shown)[1], wanted, atol=FLOAT32_VALUE)
    assert torch.equal(approximate.features(shown)[1], by_default.features(shown)[1])
    assert not torch.allclose(exact.features(shown)[1], wanted, atol=FLOAT32_VALUE)
    from_file = Clip.load(f"{name}:openai", weights[name])
    assert torch.equal(from_file.features(shown)[1], by_default.features(shown)[1])
