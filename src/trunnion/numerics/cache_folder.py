"""Where machine code is kept between runs: ``TRUNNION_CACHE``, or the user's cache folder."""

from __future__ import annotations

import os
import tempfile
import warnings
from functools import cache
from pathlib import Path

from platformdirs import user_cache_dir

from trunnion.errors import InputRemark


@cache
def cache_folder(name: str) -> Path | None:
    """The folder ``name`` of the cache, made if need be; None, with one remark, where it cannot be written."""
    chosen = chosen_folder()
    if chosen is None:
        return None
    folder = chosen / name
    try:
        _probe(folder)
    except OSError:
        _say_once(str(chosen))
        return None
    return folder


def without_a_cache(error: Exception) -> None:
    """Say that machine code could not be kept because of ``error``, such as a full disk."""
    _say_once(str(chosen_folder()), getattr(error, "strerror", None) or str(error))


def chosen_folder() -> Path | None:
    """The folder of the cache, there or not; None, with one remark, where no place is known."""
    text = os.environ.get("TRUNNION_CACHE") or _of_the_user()
    if text.startswith("~"):  # no home to expand it to: a folder named "~" would appear here
        _say_once(text, "there is no home folder")
        return None
    return Path(text).absolute()


def _of_the_user() -> str:
    try:
        return user_cache_dir("trunnion", appauthor=False)
    except RuntimeError:  # newer versions say so themselves that there is no home
        return "~/.cache/trunnion"


def _probe(folder: Path) -> None:
    if folder.is_file():  # by this name it can only be what a failing disk left
        folder.unlink()
    folder.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryFile(dir=folder):
        pass


@cache
def _say_once(folder: str, why: str = "it cannot be written") -> None:
    remark = f"the cache folder {folder} is not used ({why}), so every run compiles anew what did not come along"
    warnings.warn(InputRemark(f"{remark}; set TRUNNION_CACHE to a folder of yours"), stacklevel=2)
