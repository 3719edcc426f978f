"""A simulated easel: a machine, a sheet that takes ink, and a camera over it."""
