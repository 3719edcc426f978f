"""Field for a number, which keeps what is typed."""

from nicegui import ui


class NumberField(ui.number):
    """Field for a number; its bounds are for the browser's arrows alone, whose steps are counted from the lower one.

    What is out of them is refused in a sentence where it is used, and not pulled into them without a word.
    """

    def sanitize(self) -> None:
        """Leave what is typed as it is when the field is left."""
