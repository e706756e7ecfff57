"""Published equations and fits to compare a crater with. Numbers in, numbers out."""
