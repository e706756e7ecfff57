"""What a crater measures, from points and a Setup alone: neither the scene nor the compiled core is imported."""
