from pathlib import Path

import pytest
from pydantic import BaseModel

from maulstick.errors import InputError
from maulstick.storage.records import read_record, write_record


class Apple(BaseModel):
    """A record."""

    pips: int
    worm: str | None = None


def test_what_is_written_is_read_again(tmp_path: Path) -> None:
    write_record(Apple(pips=5), tmp_path / "apple.json")
    assert read_record(Apple, tmp_path / "apple.json", "apple") == Apple(pips=5)
    assert (tmp_path / "apple.json").read_text() == '{\n  "pips": 5\n}\n'


@pytest.mark.parametrize(("what", "said"), [("apple", "is not an apple"), ("pear", "is not a pear")])
def test_what_is_something_else_is_refused_with_its_first_fault(tmp_path: Path, what: str, said: str) -> None:
    (tmp_path / "it.json").write_text('{"pips": "many"}')
    with pytest.raises(InputError, match=rf"it\.json {said}: pips: .* \(got 'many'\)"):
        read_record(Apple, tmp_path / "it.json", what)
