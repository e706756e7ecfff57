"""What a user decides about a run: bodies, materials, grid, method; and what it will take."""
