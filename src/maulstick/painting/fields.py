"""Fields of the records of a painting: numbers as they are rounded, texts and pictures as they are kept."""

import base64
import json
from typing import Annotated, Any

from pydantic import AfterValidator, BeforeValidator, Field, JsonValue, PlainSerializer

from maulstick.painting.picture import decode_png


def _rounded(number: float) -> float:
    return round(number, 6) + 0.0  # never -0.0


def _nine_digits(number: float) -> float:
    return float(f"{number:.9g}")  # all that a float32 holds


def _encodable(text: Any) -> Any:
    return text.encode(errors="replace").decode() if isinstance(text, str) else text  # names of files may be any bytes


def _plain(options: dict[str, JsonValue]) -> dict[str, JsonValue]:
    plain: dict[str, JsonValue] = json.loads(_encodable(json.dumps(options, ensure_ascii=False, allow_nan=False)))
    return plain


def _from_base64(content: Any) -> Any:
    if not isinstance(content, str):
        return content
    try:
        return base64.b64decode(content, validate=True)
    except ValueError:
        raise ValueError("it is not base64; embed a PNG in base64") from None


def _to_base64(content: bytes) -> str:
    return base64.b64encode(content).decode()


def _decodable(content: bytes) -> bytes:
    decode_png(content)
    return content


Metres = Annotated[float, AfterValidator(_rounded)]
NineDigits = Annotated[float, AfterValidator(_nine_digits)]
Length = Annotated[float, AfterValidator(_rounded), Field(gt=0)]
Share = Annotated[float, Field(ge=0, le=1), AfterValidator(_rounded)]
Point = tuple[Metres, Metres, Share]
Colour = tuple[Share, Share, Share]
Png = Annotated[
    bytes, BeforeValidator(_from_base64), AfterValidator(_decodable), PlainSerializer(_to_base64, when_used="json")
]
Area = tuple[Metres, Metres, Length, Length]
Pose = tuple[Metres, Metres, NineDigits]
Text = Annotated[str, BeforeValidator(_encodable)]
Options = Annotated[dict[str, JsonValue], AfterValidator(_plain)]
