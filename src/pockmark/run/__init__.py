"""One run: the solver and its tasks, the run folder, what is measured and drawn of it."""
