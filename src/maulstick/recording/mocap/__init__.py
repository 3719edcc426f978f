"""Motion capture: takes of a pen and a canvas, and their conversion to ink."""
