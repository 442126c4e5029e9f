"""Compiled functions that only compiled code calls: part of their callers, and nothing by themselves.

numba optimises a function with all that it calls, and makes machine code of the whole, for that function and again in
every caller, level by level. Of what Python never calls, that is work for nothing: it is handed to its callers as it
is, and optimised and made machine code where it is used. Nothing of it is kept: what is kept is the caller.

That rests on numba's insides. Where they are others than those known here, such functions are compiled as any other,
which takes longer.
"""

from __future__ import annotations

from types import ModuleType
from typing import Any

from numba.core import caching, codegen, compiler, compiler_machinery, dispatcher, typed_passes

# numba states no types of these.
LIBRARY: Any = codegen.JITCodeLibrary
COMPILER: Any = compiler.CompilerBase
PASSES: Any = compiler.DefaultPassBuilder
LOWERING: Any = typed_passes.NativeLowering
DISPATCHER: Any = dispatcher.Dispatcher
registered: Any = compiler_machinery.register_pass
INNER = {"no_cpython_wrapper": True, "no_cfunc_wrapper": True}
"""Options of numba's ``njit`` by which such a function is known: it has no entrance for Python."""
OVERRIDDEN = ("_optimize_functions", "_optimize_final_module", "_finalize_final_module", "_finalize_dynamic_globals")
"""What ``LinkedLibrary`` takes the place of, or calls."""


class LinkedLibrary(LIBRARY):  # type: ignore[misc]
    """What a function becomes, neither optimised nor made machine code."""

    def _optimize_functions(self, module: Any) -> None:
        module.data_layout = self._codegen._data_layout

    def _optimize_final_module(self) -> None:
        pass

    def _finalize_final_module(self) -> None:
        self._finalize_dynamic_globals()
        self._finalized = True


@registered(mutates_CFG=True, analysis_only=False)
class LinkedLowering(LOWERING):  # type: ignore[misc]
    """numba's own pass with such a library, without an executable."""

    _name = "linked_lowering"

    def run_pass(self, state: Any) -> bool:
        """See numba."""
        try:
            self._link(state)
        except Exception:
            state.library, state.flags.no_compile = None, False
            super().run_pass(state)
        return True

    def _link(self, state: Any) -> None:
        library = state.library = LinkedLibrary(state.targetctx.codegen(), state.func_id.func_qualname)
        state.flags.no_compile = True
        super().run_pass(state)
        library.finalize()
        entrance = _no_entrance(state.func_id.func_qualname)
        state.targetctx.insert_user_function(entrance, state.cr.fndesc, [library])
        state.reload_init.extend(getattr(library, "_reload_init", ()))  # numba before 0.61 has none
        state.cr = state.cr._replace(cfunc=entrance)


class LinkedCompiler(COMPILER):  # type: ignore[misc]
    """numba's compiler with that pass."""

    def define_pipelines(self) -> list[Any]:
        """See numba."""
        passes = PASSES.define_nopython_pipeline(self.state)
        passes.passes = [
            (LinkedLowering, said) if kind is typed_passes.NativeLowering else (kind, said)
            for kind, said in passes.passes
        ]
        passes.finalize()
        return [passes]


def link_only(function: Any) -> None:
    """Make a compiled function, not yet used, one that is only linked into its callers, if numba is as known here."""
    if all(hasattr(LIBRARY, name) for name in OVERRIDDEN):
        function._compiler.pipeline_class = LinkedCompiler
        function._cache = caching.NullCache()


def link_inner_ones(module: ModuleType) -> None:
    """The same of all functions of a module that have no entrance for Python."""
    for one in vars(module).values():
        if isinstance(one, DISPATCHER) and INNER.items() <= one.targetoptions.items():
            link_only(one)


def _no_entrance(name: str) -> Any:
    """What stands for machine code: numba knows a compiled function by it, and calls it where Python does.

    It takes built-in functions of arguments and keywords alone. This one is of its own for each, and raises KeyError.
    """
    return "".join(("{compiled code alone calls ", name.replace(".", " "), "}")).format
