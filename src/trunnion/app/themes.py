"""The look of the page: two themes of the same colours by name, the scale of its type and of its spaces.

Light and dark are chosen by the system, or by the switch in the header; everything on the page names a colour by what
it is for (``var(--ink)``), so that both need no word of the program. Pictures are drawn for white paper; in the dark
their lightness is turned round while their hues stay (``PICTURE``), so that what was told apart by lightness, for every
kind of colour vision, still is.
"""

from __future__ import annotations

from collections.abc import Mapping

COLOURS: Mapping[str, tuple[str, str]] = {
    # what it is for: in the light, in the dark
    "ground": ("#ffffff", "#14191f"),
    "raised": ("#ffffff", "#1a2129"),
    "side": ("#f7f9fb", "#171d24"),
    "ink": ("#1a1a1a", "#e8ecf0"),
    "faint": ("#4d5760", "#a9b4be"),
    "line": ("#d5d9de", "#36414c"),
    "edge": ("#7d8791", "#7b8894"),
    "field": ("#ffffff", "#10151a"),
    "button": ("#eef1f4", "#2a333d"),
    "accent": ("#00558a", "#7cc0f0"),
    "on-accent": ("#ffffff", "#12202c"),
    "focus": ("#0072b2", "#f0b400"),
    "chosen": ("#12324a", "#cfe6f7"),
    "on-chosen": ("#ffffff", "#12202c"),
    "bar": ("#12324a", "#0c2233"),
    "on-bar": ("#ffffff", "#e8ecf0"),
    "bar-edge": ("#6f8ba0", "#6f8ba0"),
    "bar-focus": ("#f0b400", "#f0b400"),
    "bad": ("#8d0016", "#ff9c9c"),
    "bad-ground": ("#fff3f3", "#3a1a1e"),
    "note": ("#fff3d6", "#3d3214"),
    "note-edge": ("#b58900", "#c79a1e"),
    "satisfied": ("#0072b2", "#56b4e9"),
    "exceeded": ("#d55e00", "#f0904c"),
    "undecided": ("#6b6b6b", "#98a3ad"),
}
"""Blue and vermilion judge, as in pictures: told apart by every kind of colour vision."""
TEXTS = (
    ("ink", "ground"), ("ink", "raised"), ("ink", "side"), ("ink", "field"), ("ink", "button"), ("ink", "note"),
    ("faint", "ground"), ("faint", "raised"), ("faint", "side"), ("faint", "field"),
    ("accent", "ground"), ("accent", "raised"), ("accent", "side"),
    ("on-chosen", "chosen"), ("on-accent", "accent"), ("on-bar", "bar"),
    ("bad", "ground"), ("bad", "bad-ground"), ("bad", "raised"),
)  # fmt: skip
"""Colours of letters, and what they stand on."""
EDGES = (
    ("edge", "ground"), ("edge", "raised"), ("edge", "field"), ("focus", "ground"), ("focus", "raised"),
    ("focus", "field"), ("satisfied", "raised"), ("exceeded", "raised"), ("undecided", "raised"), ("bar-edge", "bar"),
    ("bar-focus", "bar"),
)  # fmt: skip
"""Colours of edges and marks that say something, and what they stand on."""
SCALE: Mapping[str, str] = {"small": "13px", "text": "15px", "large": "17px", "title": "19px"}
"""Of type."""
SPACES: Mapping[str, str] = {"near": "4px", "apart": "8px", "far": "16px"}
PICTURE = {"filter": "invert(1) hue-rotate(180deg)", "blend": "screen"}
"""What is done to a picture in the dark: white becomes black, of which only what stands upon it is seen."""
_PANEL = {
    "--design-background-color": "field",
    "--design-background-text-color": "ink",
    "--design-surface-color": "button",
    "--design-surface-text-color": "ink",
    "--design-primary-color": "accent",
    "--design-primary-text-color": "on-accent",
}
"""Names that Panel's own controls have for these."""


def css() -> str:
    """The variables of both themes, for the root of a page."""
    light, dark = (_variables(k) for k in (0, 1))
    return (
        f":root {{ color-scheme: light; {light} {_alike()} }}\n"
        f"@media (prefers-color-scheme: dark) {{ :root:not([data-theme=light]) {{ color-scheme: dark; {dark} }} }}\n"
        f":root[data-theme=dark] {{ color-scheme: dark; {dark} }}\n"
        f"@media print {{ :root, :root[data-theme] {{ color-scheme: light; {light} }} }}\n"
    )


def _variables(theme: int) -> str:
    own = "".join(f"--{name}: {pair[theme]}; " for name, pair in COLOURS.items())
    drawn = PICTURE if theme else {"filter": "none", "blend": "normal"}
    return own + "".join(f"--picture-{name}: {value}; " for name, value in drawn.items())


def _alike() -> str:
    """What both themes have, or what follows from their own."""
    sizes = "".join(f"--{name}: {value}; " for name, value in {**SCALE, **SPACES}.items())
    return sizes + "".join(f"{name}: var(--{of}); " for name, of in _PANEL.items())
