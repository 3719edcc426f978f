"""The panel Styles."""
