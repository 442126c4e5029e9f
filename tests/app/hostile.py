"""Names that would run a script wherever a page took them for more than text, and a line that bears them all."""

from __future__ import annotations

from html.parser import HTMLParser

import trunnion as tn

NAMES = (
    "<img src=x onerror=ran(1)>",
    "<script>ran(2)</script>",
    "<svg onload=ran(3)>",
    "'><img src=x onerror=ran(4)>",
    '"><img src=x onerror=ran(5)>',
    "</td></table><img src=x onerror=ran(6)>",
    "</pre><img src=x onerror=ran(7)>",
    "<iframe srcdoc='<script>parent.ran(8)</script>'></iframe>",
    "<a href=javascript:ran(9) autofocus>a</a>",
    "<input autofocus onfocus=ran(10)>",
    "<details open ontoggle=ran(11)>",
    "<video src=x onerror=ran(12)>",
    "<math><mtext><img src=x onerror=ran(13)></mtext></math>",
    "<style onload=ran(14)></style>",
    "<body onpageshow=ran(15)>",
    "$$x$$<img src=x onerror=ran(16)>",
    r"$$\href{javascript:ran(17)}{x}$$",
    r"\[x\]<img src=x onerror=ran(18)>",
    r"\(x\)<img src=x onerror=ran(19)>",
    "${ran(20)}",
    "{{ran(21)}}",
    "{%ran(22)%}",
    "`${ran(23)}`",
    "';ran(24);'",
    '";ran(25);"',
    "</script><script>ran(26)</script>",
    "<!--<img src=x onerror=ran(27)>",
    "]]><img src=x onerror=ran(28)>",
    "&lt;img src=x onerror=ran(29)&gt;",
    "&#60;img src=x onerror=ran(30)&#62;",
    "<object data=javascript:ran(31)>",
    "<embed src=javascript:ran(32)>",
    "<form><button formaction=javascript:ran(33)>",
    "<meta http-equiv=refresh content='0;javascript:ran(34)'>",
    "@name{safe}<img src=x onerror=ran(35)>",
    '""" + ran(36) + """',
    "''' + ran(37) + '''",
    "\\'''+ran(38)+'''",
    "<template><img src=x onerror=ran(39)>",
    "<marquee onstart=ran(40)>",
    "<img/src=x/onerror=ran(41)>",
    "<x onclick=ran(42) style=position:fixed;inset:0>",
)
"""More than forty, at most 80 characters each."""


def line() -> tn.Driveline:
    """A line with two joints, limits, load cases and a rule switched off, whose names and reasons are all hostile."""
    left = list(NAMES)

    def name(most: int = 80) -> str:
        """One of them, and a second where there is place."""
        first = left.pop(0)
        fits = next((n for n in reversed(left) if len(first) + len(n) <= most), None)
        if fits is None:
            return first
        left.remove(fits)
        return first + fits

    shafts, joints, disks = ([name() for _ in range(n)] for n in (3, 2, 3))
    disk = {"inertia": 0.4}
    elements = [
        tn.ConstantSpeed(name=name()),
        tn.Shaft(name=shafts[0], stiffness=1.2e4, damping=3.0),
        tn.Disk(name=disks[0], excitation=[{"order": 2, "amplitude": 30.0}], **disk),
        tn.HookeJoint(name=joints[0], angle="12 deg"),
        tn.Shaft(name=shafts[1], stiffness=8e3, damping=3.0),
        tn.Disk(name=disks[1], **disk),
        tn.HookeJoint(name=joints[1], angle="9 deg"),
        tn.Shaft(name=shafts[2], stiffness=6e3, damping=3.0),
        tn.Disk(name=disks[2], load_torque=20.0, **disk),
    ]
    cases = [tn.LoadCase(name=name(), loads={disks[2]: 50.0}), tn.LoadCase(name=name(), loads={disks[1]: 10.0})]
    off = [tn.SwitchedOff(rule="spicer-angles", reason=name())]
    operation = tn.Operation(
        speed="1500 rpm", speed_range=["600 rpm", "1800 rpm"], load_cases=cases, switched_off=off, application="road"
    )
    limits = [tn.Limit(of=shafts[0], vibratory_torque=5.0), tn.Limit(of=shafts[1], max_torque=500.0)]
    title = name()
    return tn.Driveline(elements, limits=limits, operation=operation, name=title, description=" ".join(left) or title)


class Tags(HTMLParser):
    """Tags of a page, and whatever in it could run."""

    def __init__(self, page: str) -> None:
        super().__init__(convert_charrefs=True)
        self.tags: set[str] = set()
        self.running: list[str] = []
        self.text = ""
        self.feed(page)
        self.close()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.add(tag)
        for key, value in attrs:
            leads = key in ("href", "src", "action", "data") and "javascript:" in (value or "")[:20]
            if key.startswith("on") or key in ("srcdoc", "formaction") or leads:
                self.running.append(f"{tag} {key}={value}")

    def handle_data(self, data: str) -> None:
        self.text += data
