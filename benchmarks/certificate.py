"""What a certificate of stability costs as tolerances grow in number and width: boxes, seconds of processor time.

Two shafts at ζ = 0.02 and 11° (the last disk in two parts, for an eighth number), and three shafts.
"""

from __future__ import annotations

import time

import trunnion as tn

TWO = tn.catalogue("two-shaft-cardan", angle=0.2, damping_ratio=0.02, inertia_of_disk_2=0.5)
RIM = tn.Driveline([*TWO.elements, tn.Disk(inertia=0.5, name="rim")])
THREE = tn.catalogue("three-shaft-cardan", damping_ratio=0.02)
NUMBERS = (
    "Shaft 1.stiffness", "Shaft 2.stiffness", "Disk 2.inertia", "Disk 1.inertia", "HookeJoint 1.angle",
    "Shaft 1.damping", "Shaft 2.damping", "rim.inertia",
)  # fmt: skip
NINE = [f"{kind} {i}.{key}" for i in (1, 2, 3) for kind, key in (("Shaft", "stiffness"), ("Shaft", "damping"))]
NINE += [f"Disk {i}.inertia" for i in (1, 2, 3)]


def measured(line: tn.Driveline, names: list[str], share: float, speeds: tuple[float, float], most: int) -> str:
    """One row of the table."""
    began = time.process_time()
    found = tn.certify_stability(line, dict.fromkeys(names, share), speeds, most_boxes=most)
    seconds = time.process_time() - began
    shafts = sum(e.kind == "Shaft" for e in line.elements)
    where = f"| {shafts} | {len(names)} | ±{100 * share:g} % | {speeds[0]:g} to {speeds[1]:g} "
    return where + f"| {found.boxes} | {seconds:.2f} | {100 * (1 - found.undecided_share):.4g} % |"


def main() -> None:
    """Print the table."""
    print("| shafts | tolerances | each | Ω | boxes | s | proved |\n|---|---|---|---|---|---|---|")
    for count in (1, 3, 5, 8):
        print(measured(RIM, list(NUMBERS[:count]), 0.01, (1.2, 1.5), 20_000), flush=True)
    for share, count, most in ((0.02, 3, 1000), (0.03, 3, 1000), (0.02, 8, 1000)):
        print(measured(RIM, list(NUMBERS[:count]), share, (1.2, 1.5), most), flush=True)
    print(measured(RIM, list(NUMBERS), 0.01, (0.5, 2.0), 20_000), flush=True)
    for count, speeds in ((3, (1.2, 1.25)), (9, (1.2, 1.22))):
        print(measured(THREE, NINE[-count:], 0.003, speeds, 100), flush=True)


if __name__ == "__main__":
    main()
