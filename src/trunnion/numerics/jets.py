"""Truncated Taylor series in time, so that speeds and accelerations follow from angles without differences.

A *jet* is an array whose first axis counts Taylor coefficients: ``a[k]`` = (dᵏa/dtᵏ)/k!, k = 0…order; the
other axes are whatever the caller has (angles of a turn, cases). Sums of jets are sums of arrays; this file
adds products and the few functions joint laws need, each by its classical recurrence (Moore 1966).
"""

from __future__ import annotations

import numpy as np

from trunnion.arrays import Array


def constant(value: Array | float, like: Array) -> Array:
    """Jet of something that does not change, of the order of ``like``."""
    jet = np.zeros((len(like), *np.broadcast_shapes(np.shape(value), like.shape[1:])))
    jet[0] = value
    return jet


def multiply(a: Array, b: Array) -> Array:
    """a·b."""
    return np.stack([sum(a[i] * b[k - i] for i in range(k + 1)) for k in range(len(a))])


def divide(a: Array, b: Array) -> Array:
    """a/b."""
    quotient: list[Array] = []
    for k in range(len(a)):
        quotient.append((a[k] - sum(quotient[i] * b[k - i] for i in range(k))) / b[0])
    return np.stack(quotient)


def sine_cosine(a: Array) -> tuple[Array, Array]:
    """sin a and cos a."""
    sine, cosine = [np.sin(a[0])], [np.cos(a[0])]
    for k in range(1, len(a)):
        sine.append(sum(i * a[i] * cosine[k - i] for i in range(1, k + 1)) / k)
        cosine.append(-sum(i * a[i] * sine[k - i] for i in range(1, k + 1)) / k)
    return np.stack(sine), np.stack(cosine)


def square_root(a: Array) -> Array:
    """√a."""
    root = [np.sqrt(a[0])]
    for k in range(1, len(a)):
        root.append((a[k] - sum(root[i] * root[k - i] for i in range(1, k))) / (2 * root[0]))
    return np.stack(root)


def rate(a: Array) -> Array:
    """da/dt, one order lower."""
    return np.stack([k * a[k] for k in range(1, len(a))])
