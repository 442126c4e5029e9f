"""
Where do rattling gears jump? (M. Rezaee and Farshidianfar)
===========================================================

The frequency response of a gear pair in its backlash by the exact motion, with its folds.
"""

import trunnion as tn

pair = tn.catalogue("gear-rattle")
found = tn.frequency_response(pair, 0.5, 1.2, begin=1.2)
picture = found.plot()
folds = ", ".join(f"{one:.3f}" for one in found.folds())
print(f"The response folds at ω = {folds}: between them the gears jump.")
