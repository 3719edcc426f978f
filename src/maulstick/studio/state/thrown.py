"""Record of what was thrown away, beside it in its folder in the trash."""

from typing import Final, Literal

from pydantic import BaseModel, ConfigDict

RECORD: Final = ".thrown.json"
"""Name of the record's file, which no thing has."""

STYLES_FOLDER: Final = "styles"
"""Word for the only folder outside the studio's from which things are thrown away."""


class TrashRecord(BaseModel):
    """Content of a record. where: folder that the thing was in, within the studio's, or `STYLES_FOLDER`."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    version: Literal[1] = 1
    where: str
    title: str
