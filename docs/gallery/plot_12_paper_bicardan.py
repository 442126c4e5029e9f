"""
What does a bicardan shaft do over a turn? (Săulescu, Bercan and Hudan 2007)
============================================================================

Motion and torques of the paper's transmission, whose phases are 86° from homokinetic.
"""

import trunnion as tn

turn = tn.kinetostatics(tn.catalogue("bicardan-elastic"), speed=1.0)
picture = turn.plot()
speed = turn.output_speed
print(f"The output runs from {speed.min():.4f} to {speed.max():.4f} of the input speed.")
