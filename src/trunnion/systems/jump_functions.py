"""A user's jump at a switch as a C function: compiled by numba where it can, called back where not."""

# mypy: disable-error-code="attr-defined, call-arg, misc, no-untyped-call, no-untyped-def"
# Inner functions are compiled by numba, which infers their types.
from __future__ import annotations

import ctypes
from collections.abc import Callable
from typing import Any

import numpy as np
from numba import carray, njit, types

from trunnion.systems.user_functions import POINTER, RAISED, STEP, Array, CFunction, differences, store, takes, wrap

JUMP = types.int64(types.float64, POINTER, POINTER, types.int64, types.int64, types.int64, POINTER)


def jump_function(
    function: Callable[..., Any], size: int, names: tuple[str, ...], scale: Array, *, compiled: bool = True
) -> CFunction:
    """A jump (t, x, p, which) → n numbers as a C function; tangents by differences along (x, t)."""
    takes(function, (4,), "jump")
    count, step, weight = len(names), STEP, np.array(scale, dtype=float)

    def build(uniform: Any) -> Any:
        @njit
        def evaluate(t, y, p, k, which, delay):
            x, near, out = np.empty(size), np.empty(size), np.empty(size)
            failed = 0
            for i in range(size):
                x[i] = y[i]
            for b in range(1, k + 1):
                v = y[b * size : (b + 1) * size]
                length = abs(delay[b - 1])
                for i in range(size):
                    length = max(length, abs(v[i]) / weight[i])
                if length == 0.0:
                    continue
                h = step / length
                total = np.zeros(size)
                for m in range(4):
                    move = (-2.0, -1.0, 1.0, 2.0)[m] * h
                    for i in range(size):
                        near[i] = x[i] + move * v[i]
                    failed = max(failed, store(out, uniform(t + move * delay[b - 1], near, p, which)))
                    for i in range(size):
                        total[i] += (1.0, -8.0, 8.0, -1.0)[m] / (12 * h) * out[i]
                v[:] = total
            failed = max(failed, store(out, uniform(t, x, p, which)))
            y[:size] = out
            return failed

        def jump(t, y_, p_, k, regime, which, delay_):
            y, p, delay = carray(y_, ((1 + k) * size,)), carray(p_, (count,)), carray(delay_, (max(k, 1),))
            try:
                failed = evaluate(t, y, p, k, which, delay)
            except Exception:
                failed = 1
            return failed

        return jump

    def call_back(plain: Callable[..., Any], raised: list[BaseException]) -> CFunction:
        pointer = ctypes.POINTER(ctypes.c_double)

        def jump(t: float, y_: Any, p_: Any, k: int, regime: int, which: int, delay_: Any) -> int:
            y = np.ctypeslib.as_array(y_, (1 + k, size))
            p = np.ctypeslib.as_array(p_, (count,)) if count else np.zeros(0)
            delay = np.ctypeslib.as_array(delay_, (max(k, 1),))
            try:
                for v, late in zip(y[1:], delay, strict=False):
                    whole, units = np.append(v, late), np.append(weight, 1.0)
                    point = np.append(y[0], t)
                    v[:] = differences(lambda z: plain(z[-1], z[:-1], p, which), point, whole, units)[:size]
                return store(y[0], plain(t, y[0].copy(), p, which))
            except BaseException as error:
                raised[:] = [error]
                return RAISED

        signature = ctypes.CFUNCTYPE(
            ctypes.c_int64, ctypes.c_double, pointer, pointer,
            ctypes.c_int64, ctypes.c_int64, ctypes.c_int64, pointer,
        )  # fmt: skip
        owner = signature(jump)
        return CFunction(ctypes.cast(owner, ctypes.c_void_p).value or 0, owner, False, raised)

    return wrap(function, size, names, regimes=True, kind=JUMP, call_back=call_back, build=build, compiled=compiled)
