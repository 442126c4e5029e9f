"""The ``trunnion`` command. Nothing here computes; heavy libraries load when a command needs them."""

from trunnion.cli.program import app, main

__all__ = ["app", "main"]
