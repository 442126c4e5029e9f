"""Torques as formulas: arithmetic and a few functions of ``time``, ``speed`` and ``angle``, and nothing else.

A grammar says all that there is, and the library ``lark`` reads a text by it: no name but those listed, no attribute,
index, string or call of anything else can be written, and nothing of a text is ever run by Python. What was read
becomes instructions of a machine that has a stack of numbers alone (``equations.line_kernel``).

``abs``, ``min``, ``max`` and ``step`` (0 below zero, 1 from there on) bend or jump where what they switch by changes
its sign; a motion ends there and begins again.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from math import isfinite, pi
from typing import TYPE_CHECKING, Any, NamedTuple

from trunnion.errors import InputError

if TYPE_CHECKING:
    from lark import Lark, Token, Tree

LONGEST = 4000
"""Characters of a formula."""
DEEPEST = 60
"""Levels of brackets, calls, powers and signs within one another."""
VARIABLES = {"time": "TIME_NOW", "t": "TIME_NOW", "speed": "SPEED_NOW", "angle": "ANGLE_NOW"}
CONSTANTS = {"pi": pi}
FUNCTIONS = {
    "sin": ("SIN", 1), "cos": ("COS", 1), "tan": ("TAN", 1), "atan": ("ARCTAN", 1), "exp": ("EXP", 1),
    "log": ("LOG", 1), "sqrt": ("SQRT", 1), "tanh": ("TANH", 1), "abs": ("ABS", 1), "min": ("MIN", 2),
    "max": ("MAX", 2), "step": ("STEP_AT", 1),
}  # fmt: skip
"""Instruction and number of arguments by name; log is the natural one."""
BENDS = ("ABS", "MIN", "MAX")
KINKS = (*BENDS, "STEP_AT")
ROOTS = ("SQRT", "LOG")
_OPERATORS = {"add": "PLUS", "sub": "MINUS", "mul": "TIMES", "div": "OVER_BY", "pow": "POWER"}
_GRAMMAR = r"""
    ?start: sum
    ?sum: product | sum "+" product -> add | sum "-" product -> sub
    ?product: sign | product "*" sign -> mul | product "/" sign -> div
    ?sign: power | "-" sign -> neg | "+" sign
    ?power: atom | atom ("**" | "^") sign -> pow
    ?atom: NUMBER -> number | NAME -> name | NAME "(" sum ("," sum)* ")" -> call | "(" sum ")"
    NUMBER: /([0-9]+(\.[0-9]*)?|\.[0-9]+)([eE][+-]?[0-9]+)?/
    NAME: /[A-Za-z_][A-Za-z_0-9]*/
    %ignore /[ \t]+/
"""


class Instruction(NamedTuple):
    """One step: its code's name in ``line_kernel``, and a constant's number, or 1 of a bend that keeps its sign."""

    code: str
    number: float = 0.0


@dataclass(frozen=True)
class Formula:
    """What a text says: its instructions, and what it depends on ("time", "speed", "angle").

    >>> formula("300*exp(-t/0.2)*sin(2*pi*50*t)").depends
    ('time',)
    """

    text: str
    instructions: tuple[Instruction, ...]
    depends: tuple[str, ...]

    @property
    def kinks(self) -> int:
        """How many places of it bend or jump."""
        return sum(one.code in KINKS for one in self.instructions)

    @property
    def depth(self) -> int:
        """The most numbers in hand at once."""
        height = most = 0
        for one in self.instructions:
            height += _change(one.code)
            most = max(most, height)
        return most


def _change(code: str) -> int:
    if code == "CONSTANT" or code in VARIABLES.values():
        return 1
    return -1 if code in (*_OPERATORS.values(), "MIN", "MAX") else 0


@cache
def _parser() -> Lark:
    from lark import Lark

    return Lark(_GRAMMAR, parser="lalr", maybe_placeholders=False)


@cache
def formula(text: str) -> Formula:
    """Read a formula.

    Raises
    ------
    InputError : anything but arithmetic and the functions listed; more than 4000 characters; a ``step`` by the speed.
    """
    from lark.exceptions import UnexpectedInput

    if len(text) > LONGEST:
        remedy = "write a table, or a function in Python"
        raise InputError(f"has more than {LONGEST} characters", key="formula", remedy=remedy)
    try:
        tree = _parser().parse(text)
    except UnexpectedInput as error:
        place = getattr(error, "column", -1)
        where = f"at character {place}" if isinstance(place, int) and 0 < place <= len(text) else "at its end"
        raise InputError(f"cannot be read {where}", key="formula", value=_short(text), remedy=_KNOWN) from None
    made = _Compiler(text)
    made.add(tree, 0)
    return Formula(text, tuple(made.instructions), tuple(key for key in ("time", "speed", "angle") if key in made.uses))


_KNOWN = f"write numbers, + - * / ^, {', '.join(VARIABLES)}, pi, and {', '.join(FUNCTIONS)}"


def _short(text: str) -> str:
    return text if len(text) <= 60 else text[:57] + "..."


class _Compiler:
    """Instructions in the order in which they are done, arguments first."""

    def __init__(self, text: str) -> None:
        self.text = text
        self.instructions: list[Instruction] = []
        self.uses: set[str] = set()

    def add(self, node: Tree[Token] | Token, depth: int) -> frozenset[str]:
        """Put a part of the formula in; what it depends on."""
        if depth > DEEPEST:
            raise self.wrong(f"has more than {DEEPEST} levels of brackets and signs", "write it shorter")
        children: list[Any] = list(getattr(node, "children", ()))
        match getattr(node, "data", ""):
            case "number":
                return self.constant(float(children[0]))
            case "name":
                return self.name(str(children[0]))
            case "call":
                return self.call(str(children[0]), children[1:], depth)
            case "neg":
                found = self.add(children[0], depth + 1)
                self.instructions.append(Instruction("NEGATIVE"))
                return found
        return self.chain(node, depth)

    def chain(self, node: Any, depth: int) -> frozenset[str]:
        """What is added, multiplied … from the left on, however many: no level deeper."""
        later: list[tuple[str, Any]] = []
        while getattr(node, "data", "") in ("add", "sub", "mul", "div"):
            later.append((str(node.data), node.children[1]))
            node = node.children[0]
        if not later:  # a power
            later, node = [("pow", node.children[1])], node.children[0]
        begin = len(self.instructions)
        found = self.add(node, depth + 1)
        if later[-1][0] == "pow":
            self.keep_sign(begin)
        for operator, one in reversed(later):
            found |= self.add(one, depth + 1)
            self.instructions.append(Instruction(_OPERATORS[operator]))
        return found

    def constant(self, value: float) -> frozenset[str]:
        if not isfinite(value):
            raise self.wrong("has a number beyond 1e308", "write a smaller one")
        self.instructions.append(Instruction("CONSTANT", value))
        return frozenset()

    def name(self, name: str) -> frozenset[str]:
        if name in CONSTANTS:
            return self.constant(CONSTANTS[name])
        if name not in VARIABLES:
            what = "is not a function without an argument" if name in FUNCTIONS else "is not a name that it knows"
            raise self.wrong(f"says {_short(name)}, which {what}", _KNOWN)
        self.instructions.append(Instruction(VARIABLES[name]))
        key = "time" if name == "t" else name
        self.uses.add(key)
        return frozenset([key])

    def call(self, name: str, arguments: list[Any], depth: int) -> frozenset[str]:
        if name not in FUNCTIONS:
            raise self.wrong(f"calls {_short(name)}, which is not a function that it knows", _KNOWN)
        code, count = FUNCTIONS[name]
        if len(arguments) != count:
            raise self.wrong(f"has a wrong number of arguments in {name}, {len(arguments)}", f"{name} takes {count}")
        found: frozenset[str] = frozenset()
        begin = len(self.instructions)
        for one in arguments:
            found |= self.add(one, depth + 1)
        if code in ROOTS:
            self.keep_sign(begin)
        if code == "STEP_AT" and "speed" in found:
            raise self.wrong("jumps where the speed does", "write friction, or tanh(speed/0.1) for step(speed)")
        self.instructions.append(Instruction(code))
        return found

    def keep_sign(self, since: int) -> None:
        """Let what bends among the instructions from ``since`` on be as it is wherever a step tries it.

        On the side where a step began, |x| goes on as −x behind its zero; a root or a power of that is not a number.
        """
        for k, one in enumerate(self.instructions[since:], since):
            if one.code in BENDS:
                self.instructions[k] = one._replace(number=1.0)

    def wrong(self, problem: str, remedy: str) -> InputError:
        return InputError(problem, key="formula", value=_short(self.text), remedy=remedy)
