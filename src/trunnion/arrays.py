"""Arrays by what they hold, as annotations and docstrings name them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
"""Real numbers."""
Complex = NDArray[np.complex128]
"""Amplitudes, eigenvalues, multipliers."""
Integers = NDArray[np.int64]
"""Whole numbers: orders, harmonics."""
Places = NDArray[np.intp]
"""Indices into another array."""
Flags = NDArray[np.bool_]
"""Yes or no."""
Codes = NDArray[np.int8]
"""Values of an enumeration, such as ``Verdict``."""
