"""Text that scripts of tests begin with, to count what they compile."""

COUNTER = """
import sys
from pathlib import Path
import numpy as np
from numba.core import event
from trunnion.numerics.jit import njit

class Heard(event.Listener):
    compiled = 0
    def on_start(self, event):
        Heard.compiled += 1
    def on_end(self, event):
        pass
"""
