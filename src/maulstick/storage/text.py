"""Text that people wrote, checked before it is kept, and numbers of things in words."""

from typing import Final

JOINERS: Final = "\N{ZERO WIDTH NON-JOINER}\N{ZERO WIDTH JOINER}"
"""Letters that cannot be seen, and with which words of some scripts, and emoji, are written."""


def is_printable(text: str) -> bool:
    """Return whether a text has nothing but what can be printed, and joiners."""
    return all(letter.isprintable() or letter in JOINERS for letter in text)


def made_printable(text: str) -> str:
    """Return a text with a question mark for each letter that cannot be printed, and for none at all."""
    return "".join(letter if is_printable(letter) else "?" for letter in text) or "?"


def counted(number: int, what: str, several: str = "") -> str:
    """Return a number of things in words, as "1 stroke" or "2,000 strokes"; several: where that is not with an s."""
    return f"{number:,} {what if number == 1 else several or what + 's'}"
