"""Makes the packages ``oracles`` and the known motions importable."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))
sys.path.insert(0, str(Path(__file__).parents[1] / "nonlinear"))
sys.path.insert(0, str(Path(__file__).parent))
