"""What a person sees of a run: pictures, the table."""
