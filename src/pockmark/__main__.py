"""The command `pockmark`, and `python -m pockmark`."""

import signal


def main() -> None:
    """Run the command line."""
    # Nothing can be lost while modules are imported: Ctrl-C just ends the process, without a traceback.
    heard = signal.getsignal(signal.SIGINT) is signal.default_int_handler
    if heard:
        signal.signal(signal.SIGINT, signal.SIG_DFL)
    from .cli import main as command

    if heard:
        signal.signal(signal.SIGINT, signal.default_int_handler)
    command()


if __name__ == "__main__":
    main()
