"""Planning a painting: the request, which is kept with the plan in the making, and the results."""
