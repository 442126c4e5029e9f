"""
Where does a bent resonance jump?
=================================

Duffing's oscillator over the frequency, stable and unstable motions.
"""

import trunnion as tn

branch = tn.periodic_branch(tn.reference_system("duffing"), "frequency", 0.8, 1.6)
picture = branch.plot(curve="x")
folds = [point.parameter for point in branch.special if point.kind == "fold"]
print(f"Going up the motion jumps at ω = {max(folds):.3f}, going down at ω = {min(folds):.3f}.")
