"""A line in motion, to be watched, saved and handed on."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from html import escape
from pathlib import Path
from typing import Any

from trunnion.animation.page import as_data, page
from trunnion.animation.scene import FORMAT, ShownMotion, choice
from trunnion.errors import InputError
from trunnion.live import in_notebook
from trunnion.writing import written_whole

ENDINGS = (".html", ".gif", ".json")


@dataclass(frozen=True)
class Animation:
    """Motions of a line. ``save`` writes a page, a GIF or the scene as JSON; a notebook shows it."""

    title: str
    motions: tuple[ShownMotion, ...]

    @cached_property
    def scene(self) -> dict[str, Any]:
        """All of it as plain data, as the player reads it: see ``docs/animation.md``."""
        choices = [choice(one.title, one.parts, one.movements) for one in self.motions]
        return {"format": FORMAT, "title": self.title, "choices": choices}

    @property
    def json(self) -> str:
        """The scene as JSON."""
        return as_data(self.scene)

    @cached_property
    def html(self) -> str:
        """A page that plays it, from a file too, with the network off."""
        return page(self.scene)

    def save(self, path: str | os.PathLike[str], *, seconds: float = 4.0, width: int = 720) -> Path:
        """Write a page (.html), an animated picture (.gif) or the scene (.json).

        Parameters
        ----------
        path : its ending says which; an existing file is replaced only when all is written.
        seconds : that a GIF plays.
        width : of a GIF [pixels].
        """
        ending = check_ending(path)
        with written_whole(path) as temporary:
            if ending == ".gif":
                from trunnion.animation.gif import write

                write(self.motions[0], temporary, seconds=seconds, width=width, title=self.title)
            else:
                text = self.html if ending == ".html" else self.json
                temporary.write_text(text, encoding="utf-8", newline="\n")
        return Path(path)

    def _repr_mimebundle_(self, include: object = None, exclude: object = None) -> dict[str, Any]:
        return in_notebook(self)

    def _repr_html_(self) -> str:
        shown = f'srcdoc="{escape(self.html)}" title="{escape(self.title)} in motion"'
        return f'<iframe {shown} style="width:100%;height:560px;border:0"></iframe>'

    def _lines(self) -> Iterator[str]:
        yield f"{self.title} in motion; .save(path) writes a page, a GIF or JSON"
        for one in self.motions:
            for movement in one.movements:
                yield f"  {movement.title}: {movement.said}"
                yield from (f"    {note}" for note in movement.notes)
                drawn = "size arbitrary" if movement.arbitrary else f"twist drawn {movement.factor:g} times as it is"
                yield f"    {len(movement.time)} frames over {movement.time[-1] - movement.time[0]:.4g} s; {drawn}"

    def __str__(self) -> str:
        return "\n".join(self._lines())

    def __repr__(self) -> str:
        return f"{self.title} in motion ({', '.join(one.title for one in self.motions)}); .save(path) writes it"


def together(title: str, animations: Sequence[Animation]) -> Animation:
    """Several animations on one page, to choose from."""
    return Animation(title, tuple(one for animation in animations for one in animation.motions))


def check_ending(path: str | os.PathLike[str]) -> str:
    """The ending of a file that can be written; InputError for another."""
    ending = Path(path).suffix.lower()
    if ending not in ENDINGS:
        remedy = f"end it in one of {', '.join(ENDINGS)}"
        raise InputError(
            "is not a file that an animation can be written to", key="output", value=str(path), remedy=remedy
        )
    return ending
