"""The command line: ``explore-bt``, one module per command.

Modules of this package import typer and the error classes only; what is heavy (contracts, plugins,
numba) is imported inside the commands, so that ``explore-bt --help`` answers at once.
"""

from explore_bt.cli.app import app, main

__all__ = ["app", "main"]
