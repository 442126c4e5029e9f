"""Python functions of a user as C functions: compiled by numba where it can, called back where not.

    rate(t, x, p) or rate(t, x, p, regime)  →  n numbers (array, list or tuple)

x may be unpacked (``x, v = state``); p is a named tuple of the parameters. What the wrappers return to the
integrator: 0, or RAISED, or WRONG_SHAPE.
"""

# mypy: disable-error-code="attr-defined, call-arg, misc, no-untyped-call, no-untyped-def"
# Inner functions are compiled by numba, which infers their types.
from __future__ import annotations

import ctypes
import inspect
from collections import namedtuple
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numba import carray, cfunc, literal_unroll, njit, types
from numba.core.errors import NumbaError
from numba.extending import overload
from numba.np.unsafe.ndarray import to_fixed_tuple
from numpy.typing import NDArray

from trunnion.errors import InputError

Array = NDArray[np.float64]
RAISED, WRONG_SHAPE = 1, 2
STEP = 1e-3
"""Step of the fourth-order differences, in units of a state's scale: 1e-12 of truncation and of rounding."""
MOVES, WEIGHTS = (1.0, -1.0, 2.0, -2.0), (8.0, -1.0)
"""Of such differences: where the function is called, in steps, and what each pair counts, in twelfths of a step."""
REACH = 1e-6
"""Of a state's size, what its scale counts as at least: a step below rounding would find no slope at all."""

POINTER = types.CPointer(types.float64)
RATE = types.int64(types.float64, POINTER, POINTER, types.int64, types.int64, POINTER)
GUARD = types.int64(types.float64, POINTER, POINTER, types.int64, types.int64, POINTER, POINTER)


@dataclass(frozen=True)
class CFunction:
    """A C function: its address, what keeps it alive, and whether it is machine code.

    ``raised`` holds the last exception of a function that is called back.
    """

    address: int
    owner: Any = field(repr=False, default=None)
    compiled: bool = True
    raised: list[BaseException] = field(default_factory=list, repr=False)


def store(out: Array, value: Any) -> int:
    """Write the numbers of ``value`` into ``out``; WRONG_SHAPE where there are more or fewer."""
    flat = np.asarray(value, dtype=float)
    if flat.shape != out.shape:
        return WRONG_SHAPE
    out[:] = flat
    return 0


@overload(store)
def _store(out: Any, value: Any) -> Any:
    if isinstance(value, types.BaseTuple):

        def from_tuple(out: Any, value: Any) -> int:
            if len(value) != out.size:
                return 2
            i = 0
            for number in literal_unroll(value):
                out[i] = number
                i += 1
            return 0

        return from_tuple

    def from_sequence(out: Any, value: Any) -> int:
        if len(value) != out.size:
            return 2
        for i in range(out.size):
            out[i] = value[i]
        return 0

    return from_sequence


def takes(function: Callable[..., Any], counts: tuple[int, ...], what: str) -> int:
    """How many arguments a function takes; InputError unless it is one of ``counts``."""
    plain = getattr(function, "py_func", function)
    try:
        taken = len(inspect.signature(plain).parameters)
    except (TypeError, ValueError):
        taken = counts[0]
    if taken not in counts:
        raise InputError(
            f"takes {taken} arguments where {' or '.join(map(str, counts))} are needed",
            element="System",
            key=what,
            remedy="write f(t, x, p), or f(t, x, p, regime) where there are regimes",
        )
    return taken


def parameter_tuple(names: tuple[str, ...]) -> Callable[..., Any]:
    """The type of ``p``: a named tuple where the names allow it."""
    if names and all(n.isidentifier() for n in names) and len(set(names)) == len(names):
        return namedtuple("Parameters", names, rename=True)
    return lambda *values: tuple(values)


def wrap(
    function: Callable[..., Any],
    size: int,
    names: tuple[str, ...],
    *,
    regimes: bool,
    build: Callable[..., Any],
    kind: Any,
    call_back: Callable[..., Any],
    compiled: bool = True,
    machine: Callable[..., Any] | None = None,
) -> CFunction:
    """``function`` as a C function of the signature ``kind``; see ``rate_function`` and the others.

    machine : what is compiled, where that is not ``function`` itself.
    """
    make, count = parameter_tuple(names), len(names)
    for as_tuple in (False, True) if compiled else ():
        try:
            code = cfunc(kind)(build(_uniform(machine or function, make, count, size, regimes, as_tuple)))
        except NumbaError:
            continue
        except Exception:  # numba fails on odd functions in odd ways; the interpreter can still call them
            break
        return CFunction(int(code.address or 0), code)
    raised: list[BaseException] = []

    def plain(t: float, x: Array, p: Array, regime: int) -> Any:
        arguments = (t, x.copy(), make(*map(float, p[:count])))
        return function(*arguments, regime) if regimes else function(*arguments)

    return call_back(plain, raised)


def _uniform(function: Callable[..., Any], make: Any, count: int, size: int, regimes: bool, as_tuple: bool) -> Any:
    """A compiled f(t, x, p, regime) of arrays around the user's function."""
    inner = function if hasattr(function, "py_func") else njit(function)
    named = make if isinstance(make, type) else None

    if named is not None:

        @njit
        def parameters(p):
            return named(*to_fixed_tuple(p, count))

    else:

        @njit
        def parameters(p):
            return to_fixed_tuple(p, count)

    if as_tuple:

        @njit
        def state(x):
            return to_fixed_tuple(x, size)

    else:

        @njit
        def state(x):
            return x

    if regimes:

        @njit
        def uniform(t, x, p, regime):
            return inner(t, state(x), parameters(p), regime)

    else:

        @njit
        def uniform(t, x, p, regime):
            return inner(t, state(x), parameters(p))

    return uniform


def rate_function(
    function: Callable[..., Any],
    jacobian: Callable[..., Any] | None,
    size: int,
    names: tuple[str, ...],
    scale: Array,
    *,
    compiled: bool = True,
) -> CFunction:
    """Right-hand side with tangents: exact by ``jacobian`` (t, x, p) → (n, n), else by differences."""
    regimes = takes(function, (3, 4), "rate") == 4
    sloped_by_regime = jacobian is not None and takes(jacobian, (3, 4), "jacobian") == 4
    count, step = len(names), STEP
    weight = tuple(map(float, scale))

    def with_jacobian(uniform: Any) -> Any:
        assert jacobian is not None
        matrix = _uniform(jacobian, parameter_tuple(names), count, size, sloped_by_regime, False)

        @njit
        def evaluate(t, y, p, k, regime, out):
            failed = store(out[:size], uniform(t, y[:size], p, regime))
            if failed == 0 and k > 0:
                slopes = matrix(t, y[:size], p, regime)
                for b in range(1, k + 1):
                    for i in range(size):
                        total = 0.0
                        for j in range(size):
                            total += slopes[i, j] * y[b * size + j]
                        out[b * size + i] = total
            return failed

        return evaluate

    def differenced(uniform: Any) -> Any:
        scales = np.array(weight)

        @njit
        def evaluate(t, y, p, k, regime, out):
            failed = store(out[:size], uniform(t, y[:size], p, regime))
            if k == 0:
                return failed
            x, value, opposite = np.empty(size), np.empty(size), np.empty(size)
            for b in range(1, k + 1):
                v, slope = y[b * size : (b + 1) * size], out[b * size : (b + 1) * size]
                length = 0.0
                for i in range(size):
                    length = max(length, abs(v[i]) / max(scales[i], REACH * abs(y[i])))
                slope[:] = 0.0
                if length == 0.0:
                    continue
                h = step / length
                # One place that calls the function, compiled once. In pairs, so that what does not depend on the
                # state cancels exactly.
                for m in range(4):
                    for i in range(size):
                        x[i] = y[i] + MOVES[m] * h * v[i]
                    failed = max(failed, store(value, uniform(t, x, p, regime)))
                    if m % 2 == 0:
                        opposite[:] = value
                        continue
                    for i in range(size):
                        slope[i] += WEIGHTS[m // 2] / (12 * h) * (opposite[i] - value[i])
            return failed

        return evaluate

    def build(uniform: Any) -> Any:
        evaluate = (differenced if jacobian is None else with_jacobian)(uniform)

        def rate(t, y_, p_, k, regime, out_):
            y, p = carray(y_, ((1 + k) * size,)), carray(p_, (count,))
            out = carray(out_, ((1 + k) * size,))
            try:
                failed = evaluate(t, y, p, k, regime, out)
            except Exception:
                failed = 1
            return failed

        return rate

    def call_back(plain: Callable[..., Any], raised: list[BaseException]) -> CFunction:
        pointer = ctypes.POINTER(ctypes.c_double)

        def rate(t: float, y_: Any, p_: Any, k: int, regime: int, out_: Any) -> int:
            y = np.ctypeslib.as_array(y_, ((1 + k), size))
            p = np.ctypeslib.as_array(p_, (count,)) if count else np.zeros(0)
            out = np.ctypeslib.as_array(out_, ((1 + k), size))
            try:
                failed = store(out[0], plain(t, y[0], p, regime))
                if k and not failed and jacobian is not None:
                    arguments = (t, y[0].copy(), parameter_tuple(names)(*map(float, p)))
                    slopes = jacobian(*arguments, regime) if sloped_by_regime else jacobian(*arguments)
                    out[1:] = y[1:] @ np.asarray(slopes, dtype=float).T
                elif k and not failed:
                    for v, slope in zip(y[1:], out[1:], strict=True):
                        slope[:] = differences(lambda x: plain(t, x, p, regime), y[0], v, scale)
            except BaseException as error:
                raised[:] = [error]
                return RAISED
            return failed

        signature = ctypes.CFUNCTYPE(
            ctypes.c_int64, ctypes.c_double, pointer, pointer, ctypes.c_int64, ctypes.c_int64, pointer
        )
        owner = signature(rate)
        return CFunction(ctypes.cast(owner, ctypes.c_void_p).value or 0, owner, False, raised)

    return wrap(function, size, names, regimes=regimes, kind=RATE, call_back=call_back, build=build, compiled=compiled)


def differences(f: Callable[[Array], Any], x: Array, v: Array, scale: Array) -> Array:
    """Slope of ``f`` along ``v``, by fourth-order differences in units of ``scale``."""
    length = float(np.max(np.abs(v) / np.maximum(scale, REACH * np.abs(x)), initial=0.0))
    if length == 0.0:
        return np.zeros_like(x)
    h = STEP / length
    parts = [np.asarray(f(x + m * h * v), dtype=float) for m in (-2, -1, 1, 2)]
    return np.asarray((8 * (parts[2] - parts[1]) - (parts[3] - parts[0])) / (12 * h))


def guard_function(
    function: Callable[..., Any],
    guards: int,
    size: int,
    names: tuple[str, ...],
    scale: Array,
    *,
    compiled: bool = True,
    machine: Callable[..., Any] | None = None,
) -> CFunction:
    """Switching functions (t, x, p[, regime]) → ``guards`` numbers, with gradients by differences.

    machine : what is compiled, where that is not ``function`` itself.
    """
    regimes = takes(function, (3, 4), "guard") == 4
    count, step, weight = len(names), STEP, np.array(scale, dtype=float)

    def build(uniform: Any) -> Any:
        @njit
        def evaluate(t, x, p, regime, sloped, g, slope):
            failed = store(g, uniform(t, x, p, regime))
            if sloped == 0:
                return failed
            near, other = np.empty(size), np.empty(guards)
            slope[:] = 0.0
            for j in range(size + 1):
                h = step * (weight[j] if j < size else 1.0)
                for m in range(4):
                    move = (-2.0, -1.0, 1.0, 2.0)[m] * h
                    for i in range(size):
                        near[i] = x[i] + (move if i == j else 0.0)
                    late = t + (move if j == size else 0.0)
                    failed = max(failed, store(other, uniform(late, near, p, regime)))
                    factor = (1.0, -8.0, 8.0, -1.0)[m] / (12 * h)
                    for i in range(guards):
                        slope[i * (size + 1) + j] += factor * other[i]
            return failed

        def guard(t, x_, p_, regime, sloped, g_, slope_):
            x, p = carray(x_, (size,)), carray(p_, (count,))
            g, slope = carray(g_, (guards,)), carray(slope_, (guards * (size + 1),))
            try:
                failed = evaluate(t, x, p, regime, sloped, g, slope)
            except Exception:
                failed = 1
            return failed

        return guard

    def call_back(plain: Callable[..., Any], raised: list[BaseException]) -> CFunction:
        pointer = ctypes.POINTER(ctypes.c_double)

        def guard(t: float, x_: Any, p_: Any, regime: int, sloped: int, g_: Any, slope_: Any) -> int:
            x = np.ctypeslib.as_array(x_, (size,))
            p = np.ctypeslib.as_array(p_, (count,)) if count else np.zeros(0)
            g = np.ctypeslib.as_array(g_, (guards,))
            try:
                failed = store(g, np.atleast_1d(plain(t, x, p, regime)))
                if sloped and not failed:
                    slope = np.ctypeslib.as_array(slope_, (guards, size + 1))
                    for j in range(size):
                        v = np.zeros(size)
                        v[j] = weight[j]
                        slope[:, j] = (
                            differences(lambda z: np.atleast_1d(plain(t, z, p, regime)), x, v, weight) / weight[j]
                        )
                    moved = [np.atleast_1d(plain(t + m * step, x, p, regime)) for m in (-2, -1, 1, 2)]
                    slope[:, size] = (moved[0] - 8 * moved[1] + 8 * moved[2] - moved[3]) / (12 * step)
            except BaseException as error:
                raised[:] = [error]
                return RAISED
            return failed

        signature = ctypes.CFUNCTYPE(
            ctypes.c_int64, ctypes.c_double, pointer, pointer, ctypes.c_int64, ctypes.c_int64, pointer, pointer
        )
        owner = signature(guard)
        return CFunction(ctypes.cast(owner, ctypes.c_void_p).value or 0, owner, False, raised)

    return wrap(
        function, size, names, regimes=regimes, kind=GUARD, call_back=call_back, build=build, compiled=compiled,
        machine=machine,
    )  # fmt: skip
