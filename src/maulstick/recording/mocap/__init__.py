"""Motion capture: from what cameras saw of a pen to ink."""
