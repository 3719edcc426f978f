"""Differentiable renderer: from trajectories and brushes to marks on a canvas."""
