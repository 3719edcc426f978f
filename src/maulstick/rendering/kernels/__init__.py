"""The renderer: a dense reference that is the truth, and the fast kernels that agree with it."""
