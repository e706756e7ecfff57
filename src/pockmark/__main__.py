"""python -m pockmark."""

from .cli import main

main()
