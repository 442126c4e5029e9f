"""Recompute tests/data/*.json: high-precision multipliers of random chains.

Run from the repository: ``PYTHONPATH=src:tests python tests/regenerate_references.py`` (with heyoka).
Chains are drawn from a stated seed; each is integrated in twist coordinates by heyoka in 80-bit arithmetic,
its eigenvalues are taken with 30 digits. See ``oracles.chains`` for the equations.
"""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
from oracles.chains import Chain, ExtendedPrecision, precise_multipliers, random_chain

SEED, COUNT = 20140, 200
TARGET = Path(__file__).parent / "data" / "random_chains.json"


def reference(chain: Chain, precise: ExtendedPrecision) -> dict[str, object]:
    """Chain, period in half-turns, multipliers and spectral radius."""
    values = precise_multipliers(precise.monodromy(chain))
    values = values[np.lexsort((values.imag, values.real, -np.abs(values)))]
    return {
        "chain": chain.as_dict(),
        "half_turns": round(chain.period / np.pi),
        "spectral_radius": float(np.abs(values).max()),
        "multipliers": [[float(v.real), float(v.imag)] for v in values],
    }


def main() -> None:
    """Write the file."""
    rng, precise = np.random.default_rng(SEED), ExtendedPrecision()
    chains = [random_chain(rng) for _ in range(COUNT)]
    entries = [reference(chain, precise) for chain in chains]
    about = "random chains of 2 to 8 disks and their Floquet multipliers; see tests/regenerate_references.py"
    body = ",\n".join(json.dumps(entry) for entry in entries)
    TARGET.write_text(f'{{"about": {json.dumps(about)}, "seed": {SEED}, "entries": [\n{body}\n]}}\n', encoding="utf-8")
    print(f"wrote {len(entries)} chains to {TARGET}")


if __name__ == "__main__":
    main()
