"""Objects that pickle and copy although they hold functions: those of a user, and those that answer for more points.

A pickle is for other processes of the same installation, such as those of a pool; results are kept in files by
``save`` and ``to_dict``.
"""

from __future__ import annotations

import pickle
from contextvars import ContextVar
from typing import Any


class Portable:
    """Base of classes without slots whose attributes may be functions of any kind.

    What a ``cached_property`` holds is left behind: it is computed anew where it is asked for.
    """

    def __reduce__(self) -> tuple[Any, ...]:
        if not _WITHIN.get():
            return pickle.loads, (pickled(self),)
        left = {name for kind in type(self).__mro__ for name, one in vars(kind).items() if hasattr(one, "attrname")}
        return _empty, (type(self),), {name: value for name, value in vars(self).items() if name not in left}

    def __copy__(self) -> Any:
        made = object.__new__(type(self))
        vars(made).update(vars(self))
        return made


def pickled(value: Any) -> bytes:
    """``value`` as bytes, functions by their code where they cannot be imported."""
    from numba import cloudpickle  # which pickles functions for numba itself; here, as it loads slowly

    before = _WITHIN.set(True)
    try:
        content: bytes = cloudpickle.dumps(value)  # type: ignore[no-untyped-call]
    finally:
        _WITHIN.reset(before)
    return content


def _empty(kind: type[Any]) -> Any:
    return object.__new__(kind)


_WITHIN = ContextVar("_WITHIN", default=False)
"""Whether what is being pickled is part of something portable: then what is shared is pickled once."""
