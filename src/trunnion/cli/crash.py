"""What is left of an error nobody foresaw: one line for the user, a file that can be sent."""

from __future__ import annotations

import platform
import sys
import tempfile
import traceback
from collections.abc import Sequence

from trunnion._version import __version__

HEAD = """\
Trunnion met an error it did not expect. This file says where; it names the files of the command and does not
hold their content. Please send it to the maintainers, with the driveline file if you may share it.
"""


def crash_line(error: BaseException, arguments: Sequence[str]) -> str:
    """One line that names the error and the file just written about it."""
    what = " ".join(f"unexpected {type(error).__name__}: {error}".split())
    short = what if len(what) <= 160 else f"{what[:159]}…"
    path = _written(_report(error, arguments))
    return f"{short}; this is a defect of Trunnion, please report it" + (f" with {path}" if path else "")


def _report(error: BaseException, arguments: Sequence[str]) -> str:
    command = " ".join(["trunnion", *map(repr, arguments)])
    rows = [
        f"trunnion {__version__}",
        f"python {sys.version.split()[0]} on {platform.platform()}",
        f"libraries {', '.join(_versions())}",
        f"command {command[:2000]}",
    ]
    return "\n".join([HEAD, *rows, "", *traceback.format_exception(error)])


def _versions() -> list[str]:
    names = ("numpy", "scipy", "numba", "pydantic", "pint", "xarray", "h5py", "matplotlib")
    return [f"{name} {sys.modules[name].__version__}" for name in names if name in sys.modules]


def _written(text: str) -> str | None:
    try:
        with tempfile.NamedTemporaryFile(
            "w", prefix="trunnion-", suffix="-crash.txt", delete=False, encoding="utf-8", errors="replace"
        ) as file:
            file.write(text)
            return file.name
    except OSError:
        return None
