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
import pickle
import sys
from collections import namedtuple
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cache, partial, wraps
from types import ModuleType
from typing import Any, NamedTuple

import numpy as np
from numba import carray, cfunc, literal_unroll, njit, types
from numba.core.errors import NumbaError
from numba.core.typing.ctypes_utils import to_ctypes
from numba.extending import overload
from numba.np.unsafe.ndarray import to_fixed_tuple
from numpy.typing import ArrayLike

from trunnion.arrays import Array
from trunnion.errors import InputError
from trunnion.portable import pickled

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
JUMP = types.int64(types.float64, POINTER, POINTER, types.int64, types.int64, types.int64, POINTER)

INNER = njit(no_cpython_wrapper=True, no_cfunc_wrapper=True)  # type: ignore[call-overload]
"""Compiles what compiled code alone calls: entrances for Python take longer to compile than a short function does."""


@dataclass(frozen=True)
class CFunction:
    """A C function: its address, what keeps it alive, and whether it is machine code.

    ``raised`` holds the last exception of a function that is called back. ``maker`` makes it: an address means nothing
    in another process.
    """

    address: int
    owner: Any = field(repr=False, default=None)
    compiled: bool = True
    raised: list[BaseException] = field(default_factory=list, repr=False)
    maker: Callable[[], CFunction] | None = field(default=None, repr=False, compare=False)

    def __reduce__(self) -> tuple[Callable[..., Any], tuple[Any, ...]]:
        if self.maker is None:
            return CFunction, (0,)
        made = pickled(self.maker)
        _MADE.setdefault(made, self)
        return _made_again, (made,)


_MADE: dict[bytes, CFunction] = {}
"""C functions that were pickled or unpickled here: none is compiled twice."""


def _made_again(maker: bytes) -> CFunction:
    if maker not in _MADE:
        _MADE[maker] = pickle.loads(maker)()
    return _MADE[maker]


def from_kernel(kernel: Callable[[], ModuleType], name: str) -> CFunction:
    """The C function ``name`` of a file of kernels, which a function that can be imported gives."""
    compiled = getattr(kernel(), name)
    return CFunction(compiled.address, compiled, maker=partial(from_kernel, kernel, name))


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
    """The type of ``p``: a named tuple; what is not a name in Python is there by its place alone."""
    return namedtuple("Parameters", names, rename=True)


class CompilationMode(NamedTuple):
    """How C functions are made: of machine code, or of what the interpreter calls.

    jit : compiles a function, or leaves it as it is.
    uniform : of a user's function f(t, x, p) or, the second argument says so, f(t, x, p, regime), one that takes all
        four as numbers and arrays. ``machine``: what is compiled in its place; ``arrays``: x is never a tuple.
    array : of a pointer and a shape.
    caught : the answer where a function raised.
    """

    jit: Callable[..., Any]
    uniform: Callable[..., Any]
    array: Any
    caught: Any


def remade(make: Callable[..., CFunction]) -> Callable[..., CFunction]:
    """The same function, whose C functions know how they were made."""

    @wraps(make)
    def made(*arguments: Any, **keywords: Any) -> CFunction:
        return replace(make(*arguments, **keywords), maker=partial(made, *arguments, **keywords))

    return made


def wrap(
    build: Callable[[CompilationMode], Any], kind: Any, size: int, names: tuple[str, ...], *, compiled: bool = True
) -> CFunction:
    """What ``build`` makes as a C function of the signature ``kind``: of machine code where numba can."""
    make, count = parameter_tuple(names), len(names)
    for as_tuple in (False, True) if compiled else ():

        def uniform(
            function: Any, regimes: bool, machine: Any = None, arrays: bool = False, as_tuple: bool = as_tuple
        ) -> Any:
            return _uniform(machine or function, make, count, size, regimes, as_tuple and not arrays)

        try:
            code = cfunc(kind)(build(CompilationMode(INNER, uniform, carray, INNER(lambda: RAISED))))
        except NumbaError:
            continue
        except Exception:  # numba fails on odd functions in odd ways; the interpreter can still call them
            break
        return CFunction(int(code.address or 0), code)
    raised: list[BaseException] = []

    def caught() -> int:
        error = sys.exc_info()[1]
        raised[:] = [error] if error is not None else []
        return RAISED

    def called(function: Any, regimes: bool, machine: Any = None, arrays: bool = False) -> Any:
        def plain(t: float, x: Array, p: Array, regime: int) -> Any:
            arguments = (t, x.copy(), make(*map(float, p[:count])))
            return function(*arguments, regime) if regimes else function(*arguments)

        return plain

    signature = ctypes.CFUNCTYPE(*map(to_ctypes, (kind.return_type, *kind.args)))
    owner = signature(build(CompilationMode(lambda function: function, called, np.ctypeslib.as_array, caught)))
    return CFunction(ctypes.cast(owner, ctypes.c_void_p).value or 0, owner, False, raised)


def _uniform(function: Callable[..., Any], make: Any, count: int, size: int, regimes: bool, as_tuple: bool) -> Any:
    """A compiled f(t, x, p, regime) of arrays around the user's function."""
    inner = function if hasattr(function, "py_func") else INNER(function)

    @INNER
    def parameters(p):
        return make(*to_fixed_tuple(p, count))

    if as_tuple:

        @INNER
        def state(x):
            return to_fixed_tuple(x, size)

    else:

        @INNER
        def state(x):
            return x

    if regimes:

        @INNER
        def uniform(t, x, p, regime):
            return inner(t, state(x), parameters(p), regime)

    else:

        @INNER
        def uniform(t, x, p, regime):
            return inner(t, state(x), parameters(p))

    return uniform


def _slope_along(mode: CompilationMode, uniform: Any, size: int, rows: int, scale: ArrayLike) -> Any:
    """Of a function of ``rows`` numbers its slope along v, and ``late`` in time, by fourth-order differences in units
    of ``scale``: (t, x, p, which, v, late, out) → 0, or what went wrong."""
    weight = np.array(scale, dtype=float)

    @mode.jit
    def along(t, x, p, which, v, late, out):
        x_near, value, opposite = np.empty(size), np.empty(rows), np.empty(rows)
        failed, length = 0, abs(late)
        for i in range(size):
            length = max(length, abs(v[i]) / max(weight[i], REACH * abs(x[i])))
        out[:] = 0.0
        if length == 0.0:
            return failed
        h = STEP / length
        # One place that calls the function, compiled once. In pairs, so that what does not depend on the state cancels
        # exactly.
        for m in range(4):
            for i in range(size):
                x_near[i] = x[i] + MOVES[m] * h * v[i]
            failed = max(failed, store(value, uniform(t + MOVES[m] * h * late, x_near, p, which)))
            if m % 2 == 0:
                opposite[:] = value
                continue
            for i in range(rows):
                out[i] += WEIGHTS[m // 2] / (12 * h) * (opposite[i] - value[i])
        return failed

    return along


@remade
def rate_function(
    function: Callable[..., Any],
    jacobian: Callable[..., Any] | None,
    size: int,
    names: tuple[str, ...],
    scale: ArrayLike,
    *,
    compiled: bool = True,
) -> CFunction:
    """Right-hand side with tangents: exact by ``jacobian`` (t, x, p) → (n, n), else by differences."""
    regimes = takes(function, (3, 4), "rate") == 4
    sloped_by_regime = jacobian is not None and takes(jacobian, (3, 4), "jacobian") == 4
    count = len(names)

    def with_jacobian(mode: CompilationMode) -> Any:
        def rows(*arguments: Any) -> Array:
            return np.asarray(jacobian(*arguments), dtype=np.float64)

        matrix = mode.uniform(rows, sloped_by_regime, jacobian, arrays=True)

        @mode.jit
        def tangents(t, y, p, k, regime, out):
            slopes = matrix(t, y[:size], p, regime)
            for b in range(1, k + 1):
                for i in range(size):
                    total = 0.0
                    for j in range(size):
                        total += slopes[i, j] * y[b * size + j]
                    out[b * size + i] = total
            return 0

        return tangents

    def differenced(mode: CompilationMode, uniform: Any) -> Any:
        along = _slope_along(mode, uniform, size, size, scale)

        @mode.jit
        def tangents(t, y, p, k, regime, out):
            failed = 0
            for b in range(size, (1 + k) * size, size):
                failed = max(failed, along(t, y[:size], p, regime, y[b : b + size], 0.0, out[b : b + size]))
            return failed

        return tangents

    def build(mode: CompilationMode) -> Any:
        uniform, array, caught = mode.uniform(function, regimes), mode.array, mode.caught
        tangents = differenced(mode, uniform) if jacobian is None else with_jacobian(mode)

        @mode.jit
        def evaluate(t, y, p, k, regime, out):
            failed = store(out[:size], uniform(t, y[:size], p, regime))
            return tangents(t, y, p, k, regime, out) if failed == 0 and k > 0 else failed

        def rate(t, y_, p_, k, regime, out_):
            y, p = array(y_, ((1 + k) * size,)), array(p_, (count,))
            out = array(out_, ((1 + k) * size,))
            try:
                failed = evaluate(t, y, p, k, regime, out)
            except:  # noqa: E722  a Ctrl-C that meets the interpreter, too
                failed = caught()
            return failed

        return rate

    return wrap(build, RATE, size, names, compiled=compiled)


@cache
@remade
def guard_function(
    function: Callable[..., Any],
    guards: int,
    size: int,
    names: tuple[str, ...],
    scale: tuple[float, ...],
    *,
    compiled: bool = True,
    machine: Callable[..., Any] | None = None,
) -> CFunction:
    """Switching functions (t, x, p[, regime]) → ``guards`` numbers, with gradients by differences.

    machine : what is compiled, where that is not ``function`` itself.
    """
    regimes = takes(function, (3, 4), "guard") == 4
    count = len(names)

    def flat(*arguments: Any) -> Any:
        return np.atleast_1d(function(*arguments))

    def build(mode: CompilationMode) -> Any:
        uniform, array, caught = mode.uniform(flat, regimes, machine or function), mode.array, mode.caught
        along = _slope_along(mode, uniform, size, guards, scale)

        @mode.jit
        def evaluate(t, x, p, regime, sloped, g, slope):
            failed = store(g, uniform(t, x, p, regime))
            if sloped == 0:
                return failed
            unit, column = np.zeros(size), np.empty(guards)
            for j in range(size + 1):
                if j < size:
                    unit[j] = 1.0
                failed = max(failed, along(t, x, p, regime, unit, 1.0 if j == size else 0.0, column))
                unit[:] = 0.0
                for i in range(guards):
                    slope[i * (size + 1) + j] = column[i]
            return failed

        def guard(t, x_, p_, regime, sloped, g_, slope_):
            x, p = array(x_, (size,)), array(p_, (count,))
            g, slope = array(g_, (guards,)), array(slope_, (guards * (size + 1),))
            try:
                failed = evaluate(t, x, p, regime, sloped, g, slope)
            except:  # noqa: E722
                failed = caught()
            return failed

        return guard

    return wrap(build, GUARD, size, names, compiled=compiled)


@cache
@remade
def jump_function(
    function: Callable[..., Any], size: int, names: tuple[str, ...], scale: tuple[float, ...], *, compiled: bool = True
) -> CFunction:
    """A jump (t, x, p, which) → n numbers at a switch; tangents by differences along (x, t)."""
    takes(function, (4,), "jump")
    count = len(names)

    def build(mode: CompilationMode) -> Any:
        uniform, array, caught = mode.uniform(function, True), mode.array, mode.caught
        along = _slope_along(mode, uniform, size, size, scale)

        @mode.jit
        def evaluate(t, y, p, k, which, delay):
            x, out = y[:size].copy(), np.empty(size)
            failed = store(y[:size], uniform(t, x, p, which))
            for b in range(1, k + 1):
                v = y[b * size : (b + 1) * size]
                failed = max(failed, along(t, x, p, which, v, delay[b - 1], out))
                v[:] = out
            return failed

        def jump(t, y_, p_, k, regime, which, delay_):
            y, p, delay = array(y_, ((1 + k) * size,)), array(p_, (count,)), array(delay_, (max(k, 1),))
            try:
                failed = evaluate(t, y, p, k, which, delay)
            except:  # noqa: E722
                failed = caught()
            return failed

        return jump

    return wrap(build, JUMP, size, names, compiled=compiled)
