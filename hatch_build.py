"""Puts the machine code of the kernels into a wheel where ``TRUNNION_WHEEL_KERNELS`` is set.

    TRUNNION_WHEEL_KERNELS=1 PIP_CONSTRAINT=constraints.txt python -m pip wheel --no-deps -w dist .

Such a wheel is for one Python, one platform and the numba and numpy it was built with; with others it compiles as any
other wheel does. It is compiled for a processor that nearly all have (``numerics/shipped.py``).
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

LINES = ("examples/pto-shaft.toml", "examples/truck.toml", "examples/gear-stage.toml")
"""What a first report is likely to need is what these need."""


class KernelsHook(BuildHookInterface):
    """Compiles in processes of their own, and adds what they leave."""

    def dependencies(self) -> list[str]:
        """What runs while the wheel is built: nothing, or the package itself."""
        return list(self.metadata.core.dependencies) if self._wanted() else []

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """``version`` is "standard" or "editable"; the latter compiles on the machine it is for."""
        if not self._wanted() or version == "editable":
            return
        self.gathered = tempfile.TemporaryDirectory()
        folder = Path(self.gathered.name)
        with tempfile.TemporaryDirectory() as scratch:
            self._compile(folder, Path(scratch))
        build_data["force_include"][str(folder)] = "trunnion/kernels"
        build_data["pure_python"], build_data["infer_tag"] = False, True

    def finalize(self, version: str, build_data: dict[str, Any], artifact_path: str) -> None:
        """The folder is gone when the wheel is written."""
        if hasattr(self, "gathered"):
            self.gathered.cleanup()

    def _wanted(self) -> bool:
        return self.target_name == "wheel" and bool(os.environ.get("TRUNNION_WHEEL_KERNELS"))

    def _compile(self, folder: Path, scratch: Path) -> None:
        source = Path(self.root) / "src"
        sys.path.insert(0, str(source))
        from trunnion.numerics.shipped import BUILD, PLAIN

        env = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path), "TRUNNION_CACHE": str(scratch / "cache")}
        env |= {BUILD: str(folder), "NUMBA_CPU_NAME": PLAIN, "NUMBA_CPU_FEATURES": ""}
        commands = [["warm-up"]]
        commands += [["analyze", str(Path(self.root) / line), "-o", str(scratch / "out")] for line in LINES]
        for command in commands:
            subprocess.run([sys.executable, "-m", "trunnion", *command], env=env, cwd=scratch, check=True)
