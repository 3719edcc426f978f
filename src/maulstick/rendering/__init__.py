"""The differentiable renderer: from trajectories and a brush to marks on a canvas."""
