"""How a hand's strokes lie beside and after one another."""

from maulstick.style.arrangement.arrangement import Arrangement

__all__ = ["Arrangement"]
