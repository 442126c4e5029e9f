"""How many points the kernels of charts take side by side."""

from __future__ import annotations

BATCH = 16
"""What the vector registers of a processor of today hold twice over."""
HALF = BATCH // 2
"""Points side by side where sixteen would need more registers than there are."""
