"""What every room needs: errors, units, files, plain data. It imports no other room."""
