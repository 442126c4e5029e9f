"""What ``warm-up --check`` says: how much machine code is kept, whether it is whole, and what this run can use."""

from __future__ import annotations

from collections.abc import Sequence

from numba.core.registry import cpu_target

from trunnion.cli import output
from trunnion.errors import InputError
from trunnion.numerics import shipped
from trunnion.numerics.cache_folder import chosen_folder
from trunnion.numerics.kept_code import CachedFile, found_below
from trunnion.numerics.memory import size_text
from trunnion.numerics.sources import SOURCES, VERSIONS, digest_of

REMEDY = 'run "trunnion warm-up"; whatever needs them compiles them anew in any case'
SHOWN = 5
"""Most damaged files that are named."""


def say_what_is_kept() -> None:
    """Functions, files and bytes: what this installation uses, what is of others, and what is damaged.

    Raises
    ------
    InputError : files are damaged, or there is nothing that this installation can use.
    """
    folder = chosen_folder()
    files = list(found_below(folder)) if folder is not None and folder.is_dir() else []
    damaged = [one for one in files if one.code is None]
    used = [one for one in files if _fits(one)]
    others = [one for one in files if one.code is not None and one not in used]
    output.say(f"machine code for {VERSIONS} on {_processor()}")
    output.say(f"  {folder}: {_amount(used)}")
    if shipped.in_use():
        output.say(f"  {shipped.shipped_folder()}: what came with the installation, for {shipped.PLAIN}")
    if others:
        output.say(f"  of other versions, processors or sources, which may be deleted: {_amount(others)}")
    if damaged:
        more = f" and {len(damaged) - SHOWN} more" if len(damaged) > SHOWN else ""
        output.say(f"  damaged: {', '.join(one.path.name for one in damaged[:SHOWN])}{more}")
        raise InputError(
            f"holds {len(damaged)} damaged file{'s' if len(damaged) > 1 else ''} of {len(files)}",
            element="cache folder",
            value=str(folder),
            remedy=REMEDY,
        )
    if not used and not shipped.in_use():
        problem = "holds no machine code of this installation"
        raise InputError(problem, element="cache folder", value=str(folder), remedy='run "trunnion warm-up"')


def _fits(one: CachedFile) -> bool:
    """Whether a file is of these versions, sources and processor."""
    if one.code is None or (one.code.versions, one.code.processor) != (VERSIONS, _processor()):
        return False
    folder = one.path.parent.name
    return not folder.startswith("package-") or folder == f"package-{digest_of(SOURCES)}"


def _processor() -> str:
    """The processor that code is compiled for, as LLVM names it."""
    return str(cpu_target.target_context.codegen().magic_tuple()[1])


def _amount(files: Sequence[CachedFile]) -> str:
    functions = len({one.code.function for one in files if one.code is not None})
    return f"{functions} functions in {len(files)} files, {size_text(sum(one.size for one in files))}"
