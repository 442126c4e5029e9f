"""Files of pulses as counters write them."""

from __future__ import annotations

from pathlib import Path

import numpy as np

import trunnion as tn


def write_edges(run: tn.Measurement, path: Path) -> None:
    """Times of edges as a counter writes them, with the description beside."""
    longest = max(len(one.times) for one in run.pulses)
    rows = np.full((longest, len(run.pulses)), np.nan)
    for column, one in enumerate(run.pulses):
        rows[: len(one.times), column] = one.times
    names = ",".join(one.name for one in run.pulses)
    np.savetxt(path, rows, delimiter=",", header=names, comments="", fmt="%.12g")
    channels = [
        f'[[channel]]\ncolumn = "{one.name}"\nkind = "edges"\npulses_per_turn = {one.pulses_per_turn}\n'
        f'at = "{one.at}"\nclock = "{one.clock}"\n'
        for one in run.pulses
    ]
    path.with_suffix(".channels.toml").write_text("".join(channels), encoding="utf-8")
