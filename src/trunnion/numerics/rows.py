"""Sixteen lanes as one value in compiled code: a ``Row`` is what the processor's vector registers hold.

    a = load(w, at, LIKE_A_ROW)          # w[at : at + LANES]
    store(w, at, a * b + 0.5 * c)

Rows are added, subtracted, multiplied and divided with each other and with numbers. One statement stands for sixteen,
so a kernel is written in loops and compiled in a tenth of the time that the same arithmetic takes written out lane by
lane, and nothing is left to the luck of automatic vectorisation. ``load`` takes the form of what it returns from its
last argument: with a number there it reads one number, so the same text serves one lane as well as sixteen.

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

from trunnion.numerics.batch import BATCH

_DOUBLE = ir.DoubleType()
_VECTOR = ir.VectorType(_DOUBLE, BATCH)


class RowType(types.Type):
    """Type of a row of ``BATCH`` numbers."""

    def __init__(self) -> None:
        super().__init__(name=f"Row({BATCH})")


row_type = RowType()


@register_model(RowType)
class _RowModel(models.PrimitiveModel):
    def __init__(self, manager, kind) -> None:
        super().__init__(manager, kind, _VECTOR)


def _spread(builder, number):
    """A number in every lane."""
    one = builder.insert_element(ir.Constant(_VECTOR, ir.Undefined), number, ir.Constant(ir.IntType(32), 0))
    zeros = ir.Constant(ir.VectorType(ir.IntType(32), BATCH), [0] * BATCH)
    return builder.shuffle_vector(one, ir.Constant(_VECTOR, ir.Undefined), zeros)


def _address(context, builder, signature, args, kind):
    array = context.make_array(signature.args[0])(context, builder, args[0])
    return builder.bitcast(builder.gep(array.data, [args[1]]), kind.as_pointer())


@intrinsic
def spread(typing, number):
    """A row that holds ``number`` in every lane."""

    def generate(context, builder, signature, args):
        return _spread(builder, args[0])

    return row_type(types.float64), generate


@intrinsic
def load(typing, array, at, like):
    """What stands in the flat ``array`` from ``at`` on: a row where ``like`` is one, otherwise a number."""
    kind = row_type if like == row_type else types.float64

    def generate(context, builder, signature, args):
        vector = context.get_value_type(kind)
        read = builder.load(_address(context, builder, signature, args, vector))
        read.align = 8
        return read

    return kind(array, types.int64, like), generate


@intrinsic
def store(typing, array, at, value):
    """Write a row or a number into the flat ``array`` from ``at`` on."""
    kind = row_type if value == row_type else types.float64

    def generate(context, builder, signature, args):
        written = builder.store(args[2], _address(context, builder, signature, args, context.get_value_type(kind)))
        written.align = 8
        return context.get_dummy_value()

    return types.void(array, types.int64, kind), generate


def _operator(symbol, instruction):
    row, number = row_type, types.float64
    kinds = [(row, row), (row, number), (number, row)]

    @infer_global(symbol)
    class _Operator(ConcreteTemplate):
        cases = [signature(row, *pair) for pair in kinds]

    def generate(context, builder, signature, args):
        both = [_spread(builder, a) if t == number else a for a, t in zip(args, signature.args, strict=True)]
        return getattr(builder, instruction)(*both)

    for pair in kinds:
        lower_builtin(symbol, *pair)(generate)


_operator(operator.add, "fadd")
_operator(operator.sub, "fsub")
_operator(operator.mul, "fmul")
_operator(operator.truediv, "fdiv")
