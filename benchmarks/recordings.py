"""A recording of a run-up: 60 s of four channels at 200 kHz in a binary file, to its orders.

    PYTHONPATH=src python benchmarks/recordings.py [SECONDS …]

Writes a WAV of two wheels with 60 teeth, a torque and an acceleration (16 bits; 10 kHz of these are kept), reads it,
tracks orders 1, 2 and 4, and prints the processor time of each and the memory that it took above what stood before; for
recordings of 15, 60 and 240 s, so that one sees what grows. The orders are compared with those that were written.
Numbers of the last run stand in ``benchmarks/README.md``.
"""

from __future__ import annotations

import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from scipy.io import wavfile

import trunnion as tn

RATE, TEETH, FIRST, LAST = 200_000, 60, 60.0, 300.0
ORDERS, SWING, TORQUE = (1, 2, 4), (2e-3, 5e-3, 1e-3), (30.0, 120.0, 15.0)
CHUNK = 1 << 20


def written(path: Path, seconds: float) -> None:
    """The recording, piece by piece: what turns is known in closed form."""
    count = int(seconds * RATE)
    data = np.lib.format.open_memmap(path.with_suffix(".npy"), "w+", np.int16, (count, 4))
    noise = np.random.default_rng(1)
    for begin in range(0, count, CHUNK):
        t = np.arange(begin, min(begin + CHUNK, count)) / RATE
        phase = FIRST * t + (LAST - FIRST) / seconds * t**2 / 2
        swing, torque = (
            sum(size * np.sin(order * phase) for order, size in zip(ORDERS, sizes, strict=True))
            for sizes in (SWING, TORQUE)
        )
        teeth = [np.tanh(4 * np.sin(TEETH * (phase + own))) for own in (0.0, swing)]
        both = [*teeth, torque / 250.0, torque / 500.0]
        for column, values in enumerate(both):
            data[begin : begin + len(t), column] = 30_000 * values + 30 * noise.standard_normal(len(t))
    wavfile.write(path, RATE, data)
    path.with_suffix(".npy").unlink()


FEWER = {"keep_rate": "10 kHz"}
WHEEL = {"kind": "pulses", "pulses_per_turn": TEETH, "pitch_error": 0.0}
CHANNELS = {
    "channel": [
        {"column": 1, "name": "input", **WHEEL}, {"column": 2, "name": "hub", **WHEEL},
        {"column": 3, "name": "gauge", "kind": "torque", "unit": "N*m", "scale": 250.0 / 30_000, **FEWER},
        {"column": 4, "name": "sensor", "kind": "acceleration", "unit": "rad/s^2", "scale": 500.0 / 30_000, **FEWER},
    ]
}  # fmt: skip


def held() -> float:
    """Most memory that the process has had [MB]."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


def measured(path: Path, seconds: float) -> None:
    """Read and track it, in a process of its own."""
    short = tn.Measurement([tn.PulseTrain(np.arange(4000) / 1000.0, 10, name="warm", pitch_error=0.0)])
    tn.track_orders(short, [1])
    before, begin = held(), time.process_time()
    recording = tn.read_measurement(path, CHANNELS)
    read, after = time.process_time(), held()
    found = tn.track_orders(recording, ORDERS)
    done = time.process_time()
    off = [
        np.nanmax(np.abs(np.abs(found.amplitude[2:-2, :, found.column(name)]) / sizes - 1))
        for name, sizes in (("hub", SWING), ("gauge", TORQUE))
    ]
    size = path.stat().st_size / 1e6
    print(
        f"{seconds:g} s, {size:.0f} MB: read {read - begin:.2f} s of processor time, tracked {done - read:.2f} s, "
        f"together {done - begin:.2f} s; memory +{after - before:.0f} MB read, +{held() - before:.0f} MB at most; "
        f"{len(found.speed)} windows, orders of pickup and gauge within {100 * off[0]:.2g} and {100 * off[1]:.2g} %"
    )


if __name__ == "__main__":
    if sys.argv[1:2] == ["of"]:
        measured(Path(sys.argv[2]), float(sys.argv[3]))
    else:
        for seconds in [float(one) for one in sys.argv[1:]] or [15.0, 60.0, 240.0]:
            with tempfile.TemporaryDirectory() as folder:
                file = Path(folder, "run-up.wav")
                written(file, seconds)
                subprocess.run([sys.executable, __file__, "of", str(file), str(seconds)], check=True)
