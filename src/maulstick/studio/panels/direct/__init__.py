"""Panel on which a plan is directed."""
