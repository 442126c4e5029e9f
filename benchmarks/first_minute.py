"""What the first minute of a session costs: analyze with and without compiled kernels, warm-up, small calls.

Processor seconds of whole processes (their children's too), beside seconds by the clock; medians.
"""

from __future__ import annotations

import argparse
import os
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import trunnion as tn

EXAMPLES = Path(__file__).parent.parent / "examples"


def command(*arguments: str, cache: str | None = None) -> tuple[float, float, float]:
    """Seconds until the first line on stdout and until the end, and of processor time."""
    environment = {k: v for k, v in os.environ.items() if k != "PYTHONDONTWRITEBYTECODE"}
    if cache:
        environment["TRUNNION_CACHE"] = cache
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    begin = time.perf_counter()
    run = subprocess.Popen(
        [sys.executable, "-u", "-m", "trunnion", *arguments], env=environment, stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
    )  # fmt: skip
    assert run.stdout is not None
    run.stdout.readline()
    first = time.perf_counter() - begin
    run.communicate()
    whole = time.perf_counter() - begin
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return first, whole, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def of_analyze(file: Path, runs: int) -> None:
    """``analyze`` once to compile, then timed."""
    with tempfile.TemporaryDirectory() as folder:
        command("analyze", str(file), "-o", folder)
        taken = [command("analyze", str(file), "-o", folder) for _ in range(runs)]
    first, whole, processor = (statistics.median(part) for part in zip(*taken, strict=True))
    print(f"analyze {file.name}: findings after {first:.1f} s, all after {whole:.1f} s; {processor:.1f} s of processor")


def of_cold_analyze(file: Path) -> None:
    """``analyze`` with an empty cache, as after installing."""
    with tempfile.TemporaryDirectory() as folder, tempfile.TemporaryDirectory() as cache:
        first, whole, processor = command("analyze", str(file), "-o", folder, cache=cache)
    print(
        f"the same, empty cache: findings after {first:.1f} s, all after {whole:.1f} s; {processor:.0f} s of processor"
    )


def of_warm_up() -> None:
    """``warm-up`` into an empty cache."""
    with tempfile.TemporaryDirectory() as folder:
        _, whole, processor = command("warm-up", cache=folder)
    print(f"warm-up into an empty cache: {whole:.0f} s; {processor:.0f} s of processor")


def of_call(name: str, call: Callable[[], object], times: int = 50) -> None:
    """Median milliseconds of processor time, the first call left out."""
    call()
    taken = []
    for _ in range(times):
        begin = time.thread_time()
        call()
        taken.append(time.thread_time() - begin)
    print(f"{name}: {1e3 * statistics.median(taken):.3f} ms, least {1e3 * min(taken):.3f} ms")


def of_small_calls() -> None:
    """Two shafts where they are stable and where not; the modes of 21 inertias."""
    line = tn.Driveline(
        [
            tn.ConstantSpeed(),
            tn.Shaft(stiffness="12 kN*m/rad", damping="1 N*m*s/rad"),
            tn.Disk(inertia="0.4 kg*m^2"),
            tn.HookeJoint(angle="20 deg"),
            tn.Shaft(stiffness="10 kN*m/rad", damping="1 N*m*s/rad"),
            tn.Disk(inertia="0.9 kg*m^2"),
        ]
    )
    parts: list[tn.Disk | tn.Shaft] = [tn.Disk(inertia=0.1)]
    for number in range(20):
        parts += [tn.Shaft(stiffness=1e5 + 1e3 * number, damping=1.0), tn.Disk(inertia=0.1 + 0.01 * number)]
    for rpm in (2250, 2350):
        verdict = tn.stability(line, speed=tn.rpm(rpm)).verdict
        of_call(f"stability of two shafts, {verdict}", lambda rpm=rpm: tn.stability(line, speed=tn.rpm(rpm)))
    chains = iter([tn.Driveline(parts) for _ in range(60)])
    of_call("natural_frequencies of 21 inertias, a new line", lambda: tn.natural_frequencies(next(chains)))
    known = tn.Driveline(parts)
    of_call("natural_frequencies of 21 inertias, a line known", lambda: tn.natural_frequencies(known))
    of_call("the same with shapes and damping ratios", lambda: _modes(known))


def _modes(line: tn.Driveline) -> tuple[object, object]:
    found = tn.natural_frequencies(line)
    return found.shape, found.damping_ratio


def main() -> None:
    """All, or without the compiling."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=5)
    parser.add_argument("--no-warm-up", action="store_true", help="leave out what compiles for a minute")
    chosen = parser.parse_args()
    of_small_calls()
    of_analyze(EXAMPLES / "truck.toml", chosen.runs)
    if not chosen.no_warm_up:
        of_cold_analyze(EXAMPLES / "truck.toml")
        of_warm_up()


if __name__ == "__main__":
    main()
