"""The panel Paints."""
