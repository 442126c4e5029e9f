"""Sixteen lanes as one value in compiled code: a ``Row`` is what the processor's vector registers hold.

    a = load(w, at, LIKE_A_ROW)          # w[at : at + LANES]
    store(w, at, a * b + 0.5 * c)

Rows are added, subtracted, multiplied and divided with each other and with numbers. One statement stands for sixteen,
so a kernel is written in loops and compiled in a tenth of the time that the same arithmetic takes written out lane by
lane, and nothing is left to the luck of automatic vectorisation. ``load`` takes the form of what it returns from its
last argument: with a number there it reads one number, so the same text serves one lane as well as sixteen.

``spread_half`` makes a row of half as many, for kernels that need more rows at a time than registers hold.

Functions that take or return a row are called from compiled code alone: ``numerics.jit.njit(inner=True)``.
"""

# mypy: ignore-errors
# Types are inferred by the compiler of this code, from its arguments.
from __future__ import annotations

import operator

from llvmlite import ir
from numba import types
from numba.core.typing.templates import ConcreteTemplate, infer_global, signature
from numba.extending import intrinsic, lower_builtin, models, register_model

from trunnion.numerics.batch import BATCH, HALF

_DOUBLE = ir.DoubleType()


class RowType(types.Type):
    """Type of a row of ``width`` numbers."""

    def __init__(self, width) -> None:
        super().__init__(name=f"Row({width})")
        self.width = width

    @property
    def vector(self):
        """What LLVM makes of it."""
        return ir.VectorType(_DOUBLE, self.width)


row_type, half_type = ROWS = RowType(BATCH), RowType(HALF)


@register_model(RowType)
class _RowModel(models.PrimitiveModel):
    def __init__(self, manager, kind) -> None:
        super().__init__(manager, kind, kind.vector)


def _spread(builder, number, kind):
    """A number in every lane."""
    nothing = ir.Constant(kind.vector, ir.Undefined)
    one = builder.insert_element(nothing, number, ir.Constant(ir.IntType(32), 0))
    zeros = ir.Constant(ir.VectorType(ir.IntType(32), kind.width), [0] * kind.width)
    return builder.shuffle_vector(one, nothing, zeros)


def _address(context, builder, signature, args, kind):
    array = context.make_array(signature.args[0])(context, builder, args[0])
    return builder.bitcast(builder.gep(array.data, [args[1]]), kind.as_pointer())


@intrinsic
def spread(typing, number):
    """A row that holds ``number`` in every lane."""
    return row_type(types.float64), lambda context, builder, signature, args: _spread(builder, args[0], row_type)


@intrinsic
def spread_half(typing, number):
    """A row of half as many lanes."""
    return half_type(types.float64), lambda context, builder, signature, args: _spread(builder, args[0], half_type)


@intrinsic
def load(typing, array, at, like):
    """What stands in the flat ``array`` from ``at`` on: a row where ``like`` is one, otherwise a number."""
    kind = like if like in ROWS else types.float64

    def generate(context, builder, signature, args):
        vector = context.get_value_type(kind)
        read = builder.load(_address(context, builder, signature, args, vector))
        read.align = 8
        return read

    return kind(array, types.int64, like), generate


@intrinsic
def store(typing, array, at, value):
    """Write a row or a number into the flat ``array`` from ``at`` on."""
    kind = value if value in ROWS else types.float64

    def generate(context, builder, signature, args):
        written = builder.store(args[2], _address(context, builder, signature, args, context.get_value_type(kind)))
        written.align = 8
        return context.get_dummy_value()

    return types.void(array, types.int64, kind), generate


def _operator(symbol, instruction):
    number = types.float64

    @infer_global(symbol)
    class _Operator(ConcreteTemplate):
        cases = [signature(row, *pair) for row in ROWS for pair in ((row, row), (row, number), (number, row))]

    def generate(context, builder, signature, args):
        row = signature.return_type
        both = [_spread(builder, a, row) if t == number else a for a, t in zip(args, signature.args, strict=True)]
        return getattr(builder, instruction)(*both)

    for case in _Operator.cases:
        lower_builtin(symbol, *case.args)(generate)


_operator(operator.add, "fadd")
_operator(operator.sub, "fsub")
_operator(operator.mul, "fmul")
_operator(operator.truediv, "fdiv")
