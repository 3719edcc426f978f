"""The panel Paint."""
