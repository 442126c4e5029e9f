"""A system of ordinary differential equations, smooth or with regimes, whoever wrote it.

    x′ = f(t, x, p),   p constant,   possibly another f in each of several regimes.

The right-hand side is one C function that reads an array of numbers, so a change of parameters compiles
nothing. Its signature, for those who bring a compiled one:

    int64 rate(double t, double *y, double *p, int64 k, int64 regime, double *out)

y and out are (1 + k, n): row 0 is the state and its rate, rows 1…k are tangent vectors v and (∂f/∂x) v. The
return value is 0, or anything else where f cannot be evaluated. f may leave traces in p: every integration works
on a copy.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from trunnion.arrays import Array
from trunnion.errors import InputError
from trunnion.numerics.integration.integration import Equations, kernel
from trunnion.portable import Portable
from trunnion.systems.regimes import Regimes
from trunnion.systems.user_functions import CFunction, rate_function

MOST_AT_ONCE = 8
"""Surfaces that a motion may start on together."""
ON_SURFACE = 1e-14
"""Relative to the terms of a guard, what counts as zero."""
LOOKS = 5
"""States and times at which a Jacobian is compared with differences."""
DIFFERENCE = 1e-6
"""Step of those differences over the scale of the state."""
WRONG_ENTRY = 1e-3
"""Share of an entry, and of a thousandth of the largest, by which it may differ from them."""
MOST_SHOWN = 8
"""Parameters that ``print`` shows."""
Period = float | Callable[[Mapping[str, float]], float | None] | None


@dataclass(frozen=True)
class System(Portable):
    """A system, its parameters, and the names and units of both.

    Parameters
    ----------
    name : for titles and messages.
    states, units : name and unit of each state, (n,).
    rate : the right-hand side, see the module.
    parameters, parameter_units : value of each parameter, and its unit where it has one.
    period : of the forcing [s]: a number, a function of the parameters, or None for an autonomous system.
    start : a state to begin with where the caller gives none.
    scale : the size of each state that counts as one, in which errors are measured; ones by default.
    exact_tangents : whether (∂f/∂x) v is exact; otherwise a fourth-order difference, good to about 1e-12.
    regimes : for a non-smooth system.
    divergence : tr ∂f/∂x where it is one number; otherwise None (it is then computed from the tangents).
    numbers_of : from the parameters to the array that ``rate`` receives; by default their values in order.
    function : the Python function behind ``rate``, to ask what went wrong.
    speed_unit : of a driveline, what its description prints speeds in; None for equations of one's own.

    >>> def pendulum(t, state, p):
    ...     angle, speed = state
    ...     return speed, -p.damping * speed - np.sin(angle)
    >>> system = System.from_function(pendulum, ["angle", "speed"], parameters={"damping": 0.1})
    >>> system.rate_at(0.0, [0.0, 2.0])
    array([ 2. , -0.2])
    """

    name: str
    states: tuple[str, ...]
    rate: CFunction
    parameters: Mapping[str, float] = field(default_factory=dict)
    units: tuple[str, ...] = ()
    parameter_units: Mapping[str, str] = field(default_factory=dict)
    period: Period = None
    start: Array | None = None
    scale: Array | None = None
    exact_tangents: bool = True
    regimes: Regimes | None = None
    divergence: float | Callable[[Mapping[str, float]], float] | None = None
    numbers_of: Callable[[Mapping[str, float]], Array] | None = None
    function: Callable[..., Any] | None = None
    speed_unit: str | None = None

    def __post_init__(self) -> None:
        n = len(self.states)
        if n == 0:
            raise InputError("has no states", element=self.name, key="states", remedy='write ["x", "v"], say')
        if not self.units:
            object.__setattr__(self, "units", ("1",) * n)
        scale = np.ones(n) if self.scale is None else np.array(self.scale, dtype=float)
        if scale.shape != (n,) or not np.all(np.isfinite(scale) & (scale > 0)):
            raise InputError("must be a positive number per state", element=self.name, key="scale", value=self.scale)
        object.__setattr__(self, "scale", scale)
        if self.start is not None:
            object.__setattr__(self, "start", self.checked(self.start, "start"))
        for key, value in self.parameters.items():
            if not np.isfinite(value):
                raise InputError("must be a finite number", element=self.name, key=key, value=value)
        _ = self.forcing_period

    @classmethod
    def from_function(
        cls,
        function: Callable[..., Any],
        states: Sequence[str] | int,
        *,
        parameters: Mapping[str, float] | None = None,
        period: Period = None,
        start: ArrayLike | None = None,
        jacobian: Callable[..., Any] | None = None,
        regimes: Regimes | None = None,
        name: str = "",
        units: Sequence[str] = (),
        parameter_units: Mapping[str, str] | None = None,
        scale: ArrayLike | None = None,
        divergence: float | None = None,
        compiled: bool = True,
    ) -> System:
        """A system from a Python function f(t, x, p) → n numbers, or f(t, x, p, regime) with regimes.

        Compiled by numba if it can be (some seconds, once); otherwise called back, some hundred times
        slower: ``compiled`` tells. ``x`` is an array that may be unpacked, ``p`` a named tuple.

        Parameters
        ----------
        states : their names, or how many there are.
        jacobian : (t, x, p) → ∂f/∂x (n, n); without it tangents are differenced.
        compiled : False spares the seconds of compiling function and regimes, for what is called a few times.
        """
        states = _state_names(states)
        values = {k: _number(v, name or "System", k) for k, v in (parameters or {}).items()}
        size = len(states)
        weight = np.ones(size) if scale is None else np.asarray(scale, dtype=float)
        if weight.shape != (size,):
            raise InputError("needs one number per state", element=name or "System", key="scale", value=scale)
        draft = cls(
            name=name or getattr(function, "__name__", "system"),
            states=states,
            rate=CFunction(0),
            parameters=values,
            units=tuple(units),
            parameter_units=dict(parameter_units or {}),
            period=period,
            start=start,  # type: ignore[arg-type]
            scale=weight,
            exact_tangents=jacobian is not None,
            regimes=regimes,
            divergence=divergence,
            function=function,
        )
        # Compiled last, so that a slip of the pen is answered at once.
        rate = rate_function(function, jacobian, size, tuple(values), weight, compiled=compiled)
        made = replace(draft, rate=rate)
        made.require_period()
        if jacobian is not None:
            made.require_jacobian()
        return made

    def require_jacobian(self) -> None:
        """Refuse a Jacobian that differences of the right-hand side contradict at some state near the start."""
        assert self.scale is not None
        first = np.zeros(self.size) if self.start is None else self.start
        rng, period = np.random.default_rng(0), self.forcing_period or 1.0
        for k in range(LOOKS):
            # Off symmetric places, at which a wrong entry may vanish.
            state = first + 0.1 * rng.uniform(0.5, 1.0, self.size) * np.maximum(self.scale, np.abs(first))
            time = period * (0.123 + np.sqrt(2) * k) % period
            regime = self._located(time, state) if self.regimes is not None else 0
            matrix, differences = self.jacobian(time, state, regime), self._differences(time, state, regime)
            if not (np.isfinite(matrix).all() and np.isfinite(differences).all()):
                continue
            # Each entry in the units of its states: what a change of one unit does to one unit.
            off = np.abs(matrix - differences) * self.scale[None, :] / self.scale[:, None]
            size = np.abs(differences) * self.scale[None, :] / self.scale[:, None]
            wrong = off > WRONG_ENTRY * (size + 1e-3 * size.max(initial=0.0) + 1e-300)
            if wrong.any():
                i, j = np.unravel_index(int(np.argmax(np.where(wrong, off, 0.0))), off.shape)
                raise InputError(
                    f"says ∂({self.states[i]}')/∂{self.states[j]} = {matrix[i, j]:.6g} where differences give "
                    f"{differences[i, j]:.6g}",
                    element=self.name, key="jacobian", remedy=f"correct row {i + 1}, column {j + 1}, or leave it out",
                )  # fmt: skip

    def _differences(self, time: float, state: Array, regime: int) -> Array:
        """∂f/∂x (n, n) by central differences."""
        assert self.scale is not None
        out, steps = np.empty((self.size, self.size)), DIFFERENCE * np.maximum(self.scale, np.abs(state))
        for j, step in enumerate(steps):
            ahead, behind = state.copy(), state.copy()
            ahead[j], behind[j] = state[j] + step, state[j] - step
            rise = self.rate_at(time, ahead, regime) - self.rate_at(time, behind, regime)
            out[:, j] = rise / (ahead[j] - behind[j])
        return out

    def require_period(self) -> None:
        """Refuse a forcing period after which the right-hand side is another one."""
        if self.forcing_period is None:
            return
        assert self.scale is not None
        state = 0.3 * self.scale if self.start is None else self.start
        for time in self.forcing_period * np.mod(0.123 + np.sqrt(2) * np.arange(5), 1.0):
            now, later = (self.rate_at(t, state) for t in (time, time + self.forcing_period))
            off = np.abs(later - now) / self.scale
            if np.isfinite(off).all() and off.max() > 1e-6 * (1e-300 + float(np.abs(now / self.scale).max())):
                raise InputError(
                    f"is not a period: x' is {off.max():.3g} off one period after t = {time:.4g}",
                    element=self.name, key="period", value=self.forcing_period,
                    remedy="give the period of t in f [s], or none if no one period holds",
                )  # fmt: skip

    @property
    def size(self) -> int:
        """Number of states n."""
        return len(self.states)

    @property
    def compiled(self) -> bool:
        """False where the right-hand side is called back in the interpreter."""
        return self.rate.compiled

    @cached_property
    def forcing_period(self) -> float | None:
        """The forcing period at these parameters [s]; None for an autonomous system."""
        try:
            value = self.period(self.parameters) if callable(self.period) else self.period
        except ZeroDivisionError:
            given = ", ".join(f"{k} = {v:g}" for k, v in self.parameters.items() if v == 0)
            words = f"divides by zero with {given or 'these parameters'}"
            remedy = "give a frequency above zero; leave the period out if f has no t"
            raise InputError(words, element=self.name, key="period", remedy=remedy) from None
        if value is not None and not (np.isfinite(value) and value > 0):
            remedy = "give a positive number or a function of the parameters; leave it out if f has no t"
            raise InputError("must be positive", element=self.name, key="period", value=float(value), remedy=remedy)
        return None if value is None else float(value)

    @cached_property
    def numbers(self) -> Array:
        """The array that the right-hand side receives."""
        if self.numbers_of is not None:
            return np.ascontiguousarray(self.numbers_of(self.parameters), dtype=float)
        return np.array([*self.parameters.values()], dtype=float)

    @cached_property
    def equations(self) -> Equations:
        """What the integrator takes."""
        assert self.scale is not None
        plain = (self.rate.address, self.size, self.numbers, self.scale)
        if self.regimes is None:
            return Equations(*plain)
        names, scale = tuple(self.parameters), tuple(self.scale.tolist())
        guard, jump, transitions, directions = self.regimes.compiled(self.size, names, scale, compiled=self.compiled)
        return Equations(*plain, guard.address, jump.address if jump else 0, transitions, directions)

    def but(self, **parameters: float) -> System:
        """The same system with other parameters; nothing is compiled.

        Raises
        ------
        InputError : not one of its parameters, or not a finite number.
        """
        return self.with_parameters(parameters)

    def with_parameters(self, parameters: Mapping[str, float]) -> System:
        """As ``but``, for names that are not Python names."""
        for key in parameters:
            if key not in self.parameters:
                known = ", ".join(self.parameters) or "none"
                raise InputError("is not a parameter", element=self.name, key=key, remedy=f"parameters are: {known}")
        changed = {key: float(value) for key, value in parameters.items()}
        for key, value in changed.items():
            if not math.isfinite(value):
                raise InputError("must be a finite number", element=self.name, key=key, value=value)
        made = self.with_fields(parameters={**self.parameters, **changed})
        _ = made.forcing_period
        return made

    def reading(self, numbers: Array) -> System:
        """The same right-hand side reading ``numbers``, whatever the parameters, and without a period."""
        return self.with_fields(numbers_of=lambda _: numbers, period=None)

    def with_fields(self, **changes: Any) -> System:
        """As ``dataclasses.replace``, without checking again: a system is made for every period that is integrated
        along a branch."""
        made = object.__new__(type(self))
        made.__dict__.update({name: self.__dict__[name] for name in type(self).__dataclass_fields__}, **changes)
        return made

    def rate_at(self, time: float, state: ArrayLike, regime: int = 0) -> Array:
        """x′ (n,) at one time and state; NaN where the right-hand side cannot be evaluated."""
        return self._evaluate(time, self.checked(state)[None], regime)[0]

    def jacobian_times(self, time: float, state: ArrayLike, vector: ArrayLike, regime: int = 0) -> Array:
        """(∂f/∂x) v (n,) for one vector v (n,), or (k, n) for k of them."""
        vectors = np.asarray(vector, dtype=float)
        block = np.vstack([self.checked(state), vectors.reshape(-1, self.size)])
        return self._evaluate(time, block, regime)[1:].reshape(vectors.shape)

    def jacobian(self, time: float, state: ArrayLike, regime: int = 0) -> Array:
        """∂f/∂x (n, n)."""
        return self.jacobian_times(time, state, np.eye(self.size), regime).T

    def divergence_at(self, times: Array, states: Array, regimes: NDArray[np.integer[Any]]) -> Array:
        """tr ∂f/∂x (m,) [1/s] at times (m,), states (m, n) and in regimes (m,); NaN where it cannot be evaluated."""
        n, p = self.size, self.numbers.copy()
        block, out = np.vstack([np.zeros(n), np.eye(n)]), np.empty((n + 1, n))
        flat, result, call, address = block.reshape(-1), out.reshape(-1), kernel().call_rate, self.rate.address
        traces = np.full(len(times), np.nan)
        for i, (time, state, regime) in enumerate(zip(times.tolist(), states, regimes.tolist(), strict=True)):
            block[0] = state
            if not call(address, time, flat, p, n, regime, result):
                traces[i] = out[1:].trace()
        return traces

    def regime_at(self, time: float, state: ArrayLike) -> int:
        """The regime a motion through ``state`` goes on in; 0 for a smooth system.

        On a switching surface it is the regime behind it, if the motion is about to cross.
        """
        if self.regimes is None:
            return 0
        t, x = float(time), self.checked(state)
        regime = self._located(t, x)
        for _ in range(MOST_AT_ONCE):
            then = self._crossing(t, x, regime)
            if then < 0:
                break
            regime = then
        return regime

    def _located(self, time: float, state: Array) -> int:
        assert self.regimes is not None
        found, count = self.regimes.at(time, state, self.parameters, self.numbers), len(self.regimes.names)
        if isinstance(found, bool) or int(found) != found or not 0 <= found < count:
            raise InputError(
                f"must give the number of one of {count} regimes", element=self.name, key="locate", value=found
            )
        return int(found)

    def _crossing(self, time: float, state: Array, regime: int) -> int:
        """The regime behind a surface that ``state`` lies on and leaves its own regime by; −1 where there is none."""
        equations, n = self.equations, self.size
        p, count = self.numbers.copy(), equations.transitions.shape[1]

        def rates(t: float, x: Array) -> tuple[Array, Array, Array]:
            g, slope = np.zeros(count), np.zeros(count * (n + 1))
            if kernel().call_guard(equations.guard, t, x, p, regime, g, slope):
                return np.full(count, np.nan), np.full(count, np.nan), np.zeros(n)
            slopes, rate = slope.reshape(count, n + 1), self.rate_at(t, x, regime)
            size = np.abs(slopes[:, :n]) @ np.abs(x)
            return np.where(np.abs(g) <= ON_SURFACE * size, 0.0, g), slopes[:, :n] @ rate + slopes[:, n], rate

        value, speed, rate = rates(time, state)
        for i in np.flatnonzero(value == 0):
            then, direction = equations.transitions[regime, i], equations.directions[regime, i]
            going = speed[i]
            if abs(going) <= ON_SURFACE * float(np.abs(rate).max()):
                # At rest on the surface: what it does next.
                ahead = 1e-6 * (self.forcing_period or 1.0)
                going = rates(time + ahead, state + ahead * rate)[1][i]
            if then >= 0 and (direction * going > 0 or (direction == 2 and going != 0)):
                return int(then)
        return -1

    def _evaluate(self, time: float, block: Array, regime: int) -> Array:
        flat, out = np.ascontiguousarray(block).ravel(), np.full(block.size, np.nan)
        p, count = self.numbers.copy(), len(block) - 1
        code = kernel().call_rate(self.rate.address, float(time), flat, p, count, int(regime), out)
        return np.full(block.shape, np.nan) if code else out.reshape(block.shape)

    def checked(self, state: ArrayLike, key: str = "state") -> Array:
        """``state`` as an array (n,); InputError unless it is n finite numbers."""
        try:
            value = np.asarray(state, dtype=float)
        except (TypeError, ValueError):
            words = f"must be {self.size} numbers in the order {', '.join(self.states)}"
            raise InputError(words, element=self.name, key=key, value=state) from None
        if value.shape != (self.size,) or not np.all(np.isfinite(value)):
            raise InputError(
                f"must be {self.size} finite numbers ({', '.join(self.states)})",
                element=self.name,
                key=key,
                value=value.tolist(),
            )
        return value

    def checked_start(self, start: ArrayLike) -> Array:
        """``start`` as an array (n,), within the limits of its states.

        Raises
        ------
        InputError : not n finite numbers; a state beyond its limit, as friction beyond what it holds.
        """
        state = self.checked(start, "start")
        refused = self.regimes.refusal(state, self.numbers) if self.regimes is not None else None
        if refused is not None:
            raise InputError(refused[0], element=self.name, key="start", remedy=refused[1])
        return self.within_limits(state)

    @property
    def sliders(self) -> tuple[str, ...]:
        """Names of the sliders, whose deflections are the last states."""
        return self.regimes.slider_names if self.regimes is not None else ()

    def within_limits(self, state: Array) -> Array:
        """``state`` (n,), what lies beyond its limit brought back to it."""
        limits = self.regimes.limits(self.numbers) if self.regimes is not None else None
        return state if limits is None else np.clip(state, -limits, limits)

    def __repr__(self) -> str:
        shown = [f"{k} = {v:.6g}" for k, v in self.parameters.items()]
        values = ", ".join(shown if len(shown) <= MOST_SHOWN else [*shown[:MOST_SHOWN], f"… {len(shown)} in all"])
        kind = "autonomous" if self.period is None else "forced without a common period"
        if self.forcing_period is not None:
            kind = f"forced with period {self.forcing_period:.6g}"
        speed = "" if self.compiled else "; called back in the interpreter (slow)"
        tangents = "exact" if self.exact_tangents else "differenced"
        regimes = f"; regimes {', '.join(self.regimes.names)}" if self.regimes else ""
        return (
            f"{self.name}: {self.size} states ({', '.join(self.states)}), {kind}; {values or 'no parameters'}"
            f"; tangents {tangents}{regimes}{speed}"
        )


def _number(value: object, element: str, key: str) -> float:
    try:
        return float(value)  # type: ignore[arg-type]
    except (TypeError, ValueError):
        raise InputError("must be one number", element=element, key=key, value=value) from None


def _state_names(states: Sequence[str] | int) -> tuple[str, ...]:
    if isinstance(states, int) and not isinstance(states, bool):
        return tuple(f"x{i + 1}" for i in range(states))
    if isinstance(states, str) or not isinstance(states, Sequence) or not all(isinstance(s, str) for s in states):
        raise InputError("must be a list of names or how many there are", element="System", key="states", value=states)
    if len(set(states)) < len(states):
        raise InputError("names a state twice", element="System", key="states", value=list(states))
    return tuple(states)
