import hashlib
import json
import os
from dataclasses import replace
from pathlib import Path
from threading import Thread

import numpy as np
import pytest
import torch
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from safetensors.numpy import load, save

from maulstick.errors import InputError, OutputError
from maulstick.painting.raster import Canvas
from maulstick.style import cards, load_style, store
from maulstick.style.exemplar import Exemplar
from maulstick.style.free import FreeStyle
from maulstick.style.hand import Hand
from maulstick.style.pooled import PooledHands
from maulstick.style.shape import GIST, RESIDUAL
from maulstick.style.trajvae import TrajVAE, shapes
from tests.support.tolerances import FLOAT32_METRES

CANVAS = Canvas(0.2, 0.16, 1000.0)
HANDS = PooledHands(np.diag(np.linspace(0.01, 0.5, GIST + 1)), np.full(RESIDUAL, 1e-3))


def kill_after(steps: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """From now on whoever has unlinked and replaced files so many times is killed at the next."""
    taken = 0

    def killed(act: object) -> object:
        def step(*words: object, **options: object) -> object:
            nonlocal taken
            taken += 1
            if taken > steps:
                raise KeyboardInterrupt
            return act(*words, **options)  # type: ignore[operator]

        return step

    for name in ("unlink", "replace"):
        monkeypatch.setattr(Path, name, killed(getattr(Path, name)))


def a_hand(strokes: int = 7) -> Hand:
    """Arcs of which some were pressed and some were timed."""
    bend = np.linspace(0.1, 1.0, strokes)[:, None] * np.linspace(0, np.pi, 32)
    length = np.linspace(0.01, 0.05, strokes)[:, None]
    paths = np.stack([length * np.linspace(0, 1, 32), length * np.sin(bend)], axis=-1)
    pressure, speeds = np.full((strokes, 4), 0.25), np.full((strokes, 32), 0.5)
    pressure[0], speeds[1] = np.nan, np.nan
    return Hand(paths, pressure, speeds)


def an_exemplar(name: str = "arcs") -> Exemplar:
    return Exemplar(name, a_hand(), HANDS, 0.33)


def a_trajvae() -> TrajVAE:
    torch_rng = torch.Generator().manual_seed(0)
    weights = {name: 0.1 * torch.randn(size, generator=torch_rng) for name, size in shapes().items()}
    common = {"hands.covariance": torch.eye(GIST + 1), "hands.residual": torch.ones(RESIDUAL)}
    return TrajVAE("net", a_hand(), weights | common)


@pytest.fixture
def style(tmp_path: Path) -> Path:
    """The JSON of a style."""
    return store.write_style(an_exemplar(), "a drawing of arcs", tmp_path)


@pytest.fixture
def own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The folder of own styles, of which there are none yet."""
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path))
    return tmp_path / "maulstick" / "styles"


def refusal(path: Path) -> str:
    with pytest.raises(InputError) as caught:
        store.read_style(path)
    assert "\n" not in str(caught.value)
    return str(caught.value)


def read_or_refused(path: Path) -> bool:
    try:
        return len(store.read_style(path).hand) == 7
    except InputError as error:
        return str(path.parent) in str(error) and "\n" not in str(error)


def tampered(path: Path, **arrays: object) -> Path:
    """The same style with other arrays, which its JSON knows of."""
    beside = path.with_suffix(".safetensors")
    content = save({**load(beside.read_bytes()), **arrays})  # type: ignore[dict-item]
    return forged(path, content)


def forged(path: Path, content: bytes) -> Path:
    beside = path.with_suffix(".safetensors")
    beside.write_bytes(content)
    path.write_text(json.dumps({**json.loads(path.read_text()), "sha256": hashlib.sha256(content).hexdigest()}))
    return path


@pytest.mark.parametrize("made", [an_exemplar(), a_trajvae()], ids=lambda style: style.name)
def test_a_style_is_read_as_it_was_written(made: store.Fitted, tmp_path: Path) -> None:
    path = store.write_style(made, "a drawing of arcs", tmp_path / "new" / "folder")
    read = store.read_style(path)
    assert type(read) is type(made)
    assert (read.name, read.hash, len(read.hand)) == (made.name, made.hash, len(made.hand))
    assert read.hand.paths == pytest.approx(made.hand.paths, abs=FLOAT32_METRES)
    assert np.array_equal(read.hand.pressure, made.hand.pressure, equal_nan=True)
    assert np.array_equal(read.hand.speeds, made.hand.speeds, equal_nan=True)
    codes, _ = made.sample(5, torch.Generator().manual_seed(1))
    assert torch.equal(read.decode(codes), made.decode(codes))
    assert sorted(os.listdir(path.parent)) == [path.name, path.with_suffix(".safetensors").name]


@pytest.mark.parametrize("made", [an_exemplar(), a_trajvae()], ids=lambda style: style.name)
def test_where_strokes_lay_is_kept_and_styles_without_it_have_none(made: store.Fitted, tmp_path: Path) -> None:
    poses = np.random.default_rng(0).normal(0, 0.1, (7, 3))
    placed = replace(made, hand=replace(made.hand, poses=poses))
    read = store.read_style(store.write_style(placed, "a drawing of arcs", tmp_path))
    assert read.hand.poses == pytest.approx(poses, abs=FLOAT32_METRES)
    assert read.hash == made.hash
    assert store.read_style(store.write_style(made, "a drawing of arcs", tmp_path)).hand.poses is None


def test_built_in_styles_of_a_whole_drawing_are_arranged_and_no_others() -> None:
    arranged = {path.stem for path in cards.BUILT_IN.glob("*.json") if store.read_style(path).arrangement is not None}
    assert arranged == {"elephant", "moscow"}


def test_a_card_says_what_a_style_is(style: Path) -> None:
    card = cards.read_card(style)
    assert (card.name, card.source, card.strokes) == ("arcs", "a drawing of arcs", 7)
    assert card.settings == cards.ExemplarSettings(freedom=0.33)


def test_what_many_hands_have_in_common_is_read_as_it_was_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    store.write_hands(HANDS, tmp_path)
    monkeypatch.setattr(store, "BUILT_IN", tmp_path)
    assert np.array_equal(store.load_hands().covariance, HANDS.covariance)
    assert np.array_equal(store.load_hands().residual, HANDS.residual)


def test_every_style_that_comes_along_draws(own: Path) -> None:
    names = list(cards.STYLES.paths())
    assert len(names) >= 5
    for name in names:
        style = load_style(name, CANVAS)
        codes, pressure = style.sample(4, torch.Generator().manual_seed(0))
        assert style.name == name
        assert style.decode(codes).isfinite().all()
        assert ((pressure >= 0) & (pressure <= 1)).all()
    assert (store.load_hands().residual > 0).all()


def test_a_style_is_found_by_its_name_or_by_the_path_of_its_file(own: Path) -> None:
    path = store.write_style(an_exemplar(), "", own)
    assert load_style("arcs", CANVAS).name == load_style(str(path), CANVAS).name == "arcs"
    assert isinstance(load_style("free", CANVAS), FreeStyle)


def test_a_style_that_is_not_there_is_refused_with_all_that_are(own: Path) -> None:
    store.write_style(an_exemplar(), "", own)
    built_in = sorted(set(cards.STYLES.paths()) - {"arcs"})
    with pytest.raises(InputError) as caught:
        load_style("rococo", CANVAS)
    there = ", ".join(sorted(["FILE.json", "arcs", "free", *built_in]))
    assert str(caught.value) == f"there is no style 'rococo'; there are: {there}"
    with pytest.raises(InputError, match=r"there is no style none\.json; check its name and folder"):
        load_style("none.json", CANVAS)


@pytest.mark.parametrize("name", ["../x", "a/b", "", "-a", "free", "Cat", "a" * 41, "a\n", "ä", ".json", "con.json"])
def test_a_name_is_never_a_path(name: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"the name of a style is .*; it must be up to 40 of a-z, 0-9 and -"):
        store.write_style(an_exemplar(name), "", tmp_path)
    assert not os.listdir(tmp_path)


def test_a_built_in_style_keeps_its_name_and_an_own_one_unless_told_otherwise(own: Path) -> None:
    built_in = next(iter(cards.STYLES.paths()))
    with pytest.raises(InputError, match=f"the style {built_in} comes with Maulstick; choose another name"):
        cards.STYLES.check_own_name(built_in, overwrite=True)
    assert cards.STYLES.check_own_name("arcs", overwrite=False) == "arcs"
    store.write_style(an_exemplar(), "", own)
    with pytest.raises(OutputError, match="there is a style arcs already; choose another name, or add overwrite"):
        cards.STYLES.check_own_name("arcs", overwrite=False)
    assert cards.STYLES.check_own_name("arcs", overwrite=True) == "arcs"


def test_an_own_style_does_not_hide_a_built_in_one(own: Path) -> None:
    built_in = next(iter(cards.STYLES.paths()))
    store.write_style(an_exemplar(built_in), "", own)
    assert cards.STYLES.is_built_in(cards.STYLES.paths()[built_in])


@pytest.mark.parametrize("fails_at", range(7))
def test_a_write_that_is_killed_leaves_no_pair_that_does_not_match(
    style: Path, monkeypatch: pytest.MonkeyPatch, fails_at: int
) -> None:
    before = store.read_style(style).hash
    kill_after(fails_at, monkeypatch)
    other = replace(an_exemplar(), hands=PooledHands(HANDS.covariance, 2 * HANDS.residual))
    with pytest.raises(KeyboardInterrupt):
        store.write_style(other, "", style.parent)
    monkeypatch.undo()
    assert not style.exists() or store.read_style(style).hash == before
    assert style.exists() or fails_at > 4, "only once all is written does anything go"


def test_two_that_write_one_style_at_the_same_moment_leave_the_files_of_one(
    own: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    one, other = an_exemplar(), replace(an_exemplar(), hand=a_hand(8))
    also = Thread(target=store.write_style, args=(other, "the other", own))
    replaced = Path.replace

    def slowly(path: Path, target: Path) -> Path:
        moved = replaced(path, target)
        if target.name == "arcs.safetensors" and not also.ident:
            also.start()
            also.join(timeout=0.5)  # longer than it takes where nothing holds it up
        return moved

    monkeypatch.setattr(Path, "replace", slowly)
    path = store.write_style(one, "the one", own)
    also.join()
    assert len(store.read_style(path).hand) == 8


def test_of_two_that_take_one_name_at_the_same_moment_only_one_gets_it(
    own: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    refused = []

    def write_the_other() -> None:
        with pytest.raises(OutputError) as caught:
            store.write_style(replace(an_exemplar(), hand=a_hand(8)), "the other", own, overwrite=False)
        refused.append(str(caught.value))

    also = Thread(target=write_the_other)
    replaced = Path.replace

    def slowly(path: Path, target: Path) -> Path:
        if target.name == "arcs.safetensors" and not also.ident:
            also.start()
            also.join(timeout=0.5)  # longer than it takes where nothing holds it up
        return replaced(path, target)

    monkeypatch.setattr(Path, "replace", slowly)
    path = store.write_style(an_exemplar(), "the one", own, overwrite=False)
    also.join()
    assert refused == ["there is a style arcs already; choose another name, or add overwrite"]
    assert store.read_card(path).source == "the one"


def test_a_full_disk_loses_nothing(style: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(_: int) -> None:
        raise OSError(28, "No space left on device")

    before = {path.name: path.read_bytes() for path in style.parent.iterdir()}
    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(OutputError) as caught:
        store.write_style(a_trajvae(), "", style.parent)
    written = style.with_name("net.safetensors")
    assert str(caught.value) == f"cannot write {written}: the disk is full; free some space and run again"
    assert {path.name: path.read_bytes() for path in style.parent.iterdir()} == before


def test_a_folder_that_cannot_be_made_is_one_line(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    with pytest.raises(OutputError, match=r"cannot write into the folder of styles .*: Not a directory"):
        store.write_style(an_exemplar(), "", tmp_path / "file" / "styles")


def test_arrays_without_their_card_and_those_of_another_style_are_refused(style: Path, tmp_path: Path) -> None:
    beside = style.with_suffix(".safetensors")
    other = store.write_style(replace(an_exemplar(), freedom=0.0, hand=a_hand(8)), "", tmp_path / "other")
    style.write_bytes(other.read_bytes())
    assert refusal(style) == f"{beside} does not belong to {style}, or it is damaged; copy both files again"
    beside.unlink()
    assert refusal(style) == f"{style} has no arcs.safetensors beside it; copy both"


@pytest.mark.parametrize(
    ("change", "text"),
    [
        ({"version": 2}, "version: Input should be 1"),
        ({"name": "../x"}, "name: String should match pattern"),
        ({"strokes": -1}, "strokes: Input should be greater than or equal to 5"),
        ({"source": "\x1b[31m"}, "source: a name must be made of printable characters"),
        ({"settings": {"kind": "magic"}}, "settings: Input tag 'magic' found using 'kind' does not match"),
        ({"settings": {"kind": "exemplar", "freedom": 2}}, "settings.exemplar.freedom: Input should be less than"),
        ({"settings": {"kind": "exemplar", "freedom": float("nan")}}, "settings.exemplar.freedom: Input should be a f"),
        ({"run": "me"}, "run: Extra inputs are not permitted"),
    ],
)
def test_a_card_with_a_fault_is_refused_by_the_name_of_the_field(
    style: Path, change: dict[str, object], text: str
) -> None:
    style.write_text(json.dumps({**json.loads(style.read_text()), **change}))
    assert refusal(style).startswith(f"{style} is not a style: {text}")


@pytest.mark.parametrize(
    ("change", "text"),
    [
        (
            {"paths": np.zeros((7, 31, 2), np.float32)},
            "paths is float32 of shape (7, 31, 2); it must be floating point",
        ),
        ({"paths": np.zeros((7, 32, 2), np.int32)}, "paths is int32 of shape (7, 32, 2); it must be floating point"),
        ({"paths": np.zeros((7, 32, 2))}, "a stroke of it is no standardised path of 0.1 mm to 100 m"),
        ({"paths": np.full((7, 32, 2), np.nan)}, "a stroke of it is no standardised path of 0.1 mm to 100 m"),
        ({"paths": 1 + a_hand().paths}, "a stroke of it is no standardised path of 0.1 mm to 100 m"),
        ({"paths": 1e4 * a_hand().paths}, "a stroke of it is no standardised path of 0.1 mm to 100 m"),
        ({"pressure": np.full((7, 4), 1.5)}, "its pressure are impossible, or known along a part of a stroke only"),
        (
            {"pressure": np.tile([0.5, np.nan], (7, 2))},
            "its pressure are impossible, or known along a part of a stroke only",
        ),
        ({"speeds": np.full((7, 32), np.inf)}, "its speeds are impossible, or known along a part of a stroke only"),
        ({"poses": np.zeros((6, 3))}, "poses is float64 of shape (6, 3); it must be floating point of shape (7, 3)"),
        ({"poses": np.full((7, 3), np.nan)}, "a stroke of it lies nowhere"),
        ({"covariance": -HANDS.covariance}, "covariance must be positive definite"),
        ({"covariance": np.triu(np.ones((17, 17)))}, "covariance must be finite and symmetric"),
        ({"residual": np.zeros(RESIDUAL)}, "residual must be finite and above 0"),
    ],
)
def test_arrays_without_sense_are_refused(style: Path, change: dict[str, object], text: str) -> None:
    beside = style.with_suffix(".safetensors")
    assert refusal(tampered(style, **change)).startswith(f"{beside} does not hold a style: {text}")


def test_a_network_without_all_its_layers_is_refused(tmp_path: Path) -> None:
    path = store.write_style(a_trajvae(), "", tmp_path)
    arrays = load(path.with_suffix(".safetensors").read_bytes())
    del arrays["net.unit"]
    assert "does not hold a style: the network's unit is missing" in refusal(forged(path, save(arrays)))


def test_nothing_is_unpickled(style: Path) -> None:
    assert "does not hold a style" in refusal(forged(style, b"\x80\x04cos\nsystem\n(S'false'\ntR."))


@settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(at=st.floats(0, 1), byte=st.integers(0, 255), cut=st.booleans(), known=st.booleans())
def test_a_damaged_file_is_refused_or_read_but_never_a_traceback(
    style: Path, at: float, byte: int, cut: bool, known: bool
) -> None:
    beside = style.with_suffix(".safetensors")
    whole = (style.read_bytes(), beside.read_bytes())
    target = beside if known else style
    content = bytearray(target.read_bytes())
    place = min(int(at**4 * len(content)), len(content) - 1)  # headers come first
    content[place:] = b"" if cut else bytes([byte]) + content[place + 1 :]
    try:
        if known:
            forged(style, bytes(content))
        else:
            style.write_bytes(bytes(content))
        assert read_or_refused(style)
    finally:
        style.write_bytes(whole[0])
        beside.write_bytes(whole[1])
