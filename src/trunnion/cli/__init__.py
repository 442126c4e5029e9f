"""The ``trunnion`` command. Nothing here computes; heavy libraries load when a command needs them."""

import os

# The matrices of a line are small: threads of the linear algebra would wait for each other, and ours are above it.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

from trunnion.cli.program import app, main

__all__ = ["app", "main"]
