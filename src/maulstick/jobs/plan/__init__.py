"""Planning a painting: what was asked, kept beside the plan in the making, and what becomes of it."""
