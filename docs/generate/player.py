"""The line that turns on the home page: the player of ``trunnion animate``, on paper and in the repository a picture."""

from __future__ import annotations

from pathlib import Path

ROOT = Path(__file__).parents[2]
LINE = "examples/pto-shaft.toml"
SPEED = "300 rpm"
FILE = "pto-shaft-in-motion.html"
PICTURE = "(images/turning.gif)"
CAPTION = (
    f"The power take-off shaft at {SPEED}, where its verdict below binds: colour is the torque of each shaft, and its twist is "
    "drawn larger, as the slider says. Drag turns the picture. Made by `trunnion animate examples/pto-shaft.toml --what response "
    f'--speed "{SPEED}" -o {FILE}` ([the line in motion](animation.md)).'
)


def write_page(path: Path) -> None:
    """One file that fetches nothing."""
    import trunnion as tn

    tn.animate(tn.load(ROOT / LINE), "response", speed=SPEED).save(path)


def embedded(page: str) -> str:
    """The home page with the player above its picture, which is kept for paper."""
    start = page.rindex("\n\n", 0, page.index(PICTURE)) + 2
    end = page.index("\n\n", start)
    frame = (
        f'```{{raw}} html\n<iframe class="home-player" src="_static/{FILE}" '
        'title="A power take-off shaft that turns: two joints, three shafts, their torque as colour"></iframe>\n```'
    )
    picture = f"::::{{container}} home-on-paper\n\n{page[start:end]}\n\n::::"
    return "\n\n".join([page[: start - 2], frame, CAPTION, picture]) + page[end:]
