"""Models of Modelica.Mechanics.Rotational whose components stand by themselves, joined by ``connect``.

Read are Inertia, SpringDamper, IdealGear, Fixed, ConstantSpeed, ConstantTorque, and Damper between an inertia and a
Fixed of its own, with numbers as parameters: what ``trunnion.exchange.modelica`` writes.
"""

from __future__ import annotations

import math
import re
from collections import Counter
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from trunnion.errors import InputError, short
from trunnion.exchange.modelica import ROTATIONAL
from trunnion.exchange.network import FlangeDrive, FlangeGear, FlangeInertia, FlangeSpring, Network, read_ratio

_TOKEN = re.compile(
    r"""\s+|//[^\n]*|/\*.*?\*/|(?P<text>"(?:[^"\\]|\\.)*")|(?P<number>\d+(?:\.\d*)?(?:[eE][+-]?\d+)?)"""
    r"""|(?P<word>[A-Za-z_]\w*(?:\.[A-Za-z_]\w*)*)|(?P<mark>[-+(),;=/])""",
    re.DOTALL | re.ASCII,
)
_PORTS = {
    "Components.Inertia": ("flange_a", "flange_b"),
    "Components.SpringDamper": ("flange_a", "flange_b"),
    "Components.Damper": ("flange_a", "flange_b"),
    "Components.IdealGear": ("flange_a", "flange_b"),
    "Components.Fixed": ("flange",),
    "Sources.ConstantSpeed": ("flange",),
    "Sources.ConstantTorque": ("flange",),
}
_PARAMETERS = {
    "Components.Inertia": ("J",),
    "Components.SpringDamper": ("c", "d"),
    "Components.Damper": ("d",),
    "Components.IdealGear": ("ratio",),
    "Components.Fixed": (),
    "Sources.ConstantSpeed": ("w_fixed",),
    "Sources.ConstantTorque": ("tau_constant",),
}
START = "w.start"
"""The speed of an inertia at which a simulation begins."""
_WRITTEN = "write it as trunnion export FILE --to modelica does"


@dataclass(frozen=True)
class _Component:
    kind: str
    key: str
    values: dict[str, str]
    name: str


def read_model(text: str, source: str) -> Network:
    """The network of a model.

    Raises
    ------
    InputError : names what cannot be read.
    """
    name, components, joints = _Statements(text, source).read()
    flange = _flanges(components, joints, source)
    return _Made(name, components, flange, source).network()


class _Statements:
    """The words of a model, and what they declare and connect."""

    def __init__(self, text: str, source: str) -> None:
        self.source, self.words, self.at = source, _words(text, source), 0

    def read(self) -> tuple[str, list[_Component], list[tuple[str, str]]]:
        self.take("model")
        title = self.take()
        name = _untexted(self.take()) if self.next.startswith('"') else title
        components: list[_Component] = []
        joints: list[tuple[str, str]] = []
        while self.next not in ("equation", "end"):
            components.append(self.component())
        if self.next == "equation":
            self.take()
        while self.next == "connect":
            self.take()
            self.take("(")
            one = self.take()
            self.take(",")
            joints.append((one, self.take()))
            self.take(")")
            self.take(";")
        self.take("end")
        self.take(title)
        self.take(";")
        if self.next:
            raise self.wrong(self.next)
        return name, components, joints

    def component(self) -> _Component:
        kind, values = self.take(), {}
        place = kind.removeprefix(f"{ROTATIONAL}.")
        if place not in _PORTS or place == kind:
            problem = f"is a {short(kind, 60)}, which lines do not have"
            raise InputError(problem, element=self.source, key=short(self.next, 60), remedy=_WRITTEN)
        key = self.take()
        if self.next == "(":
            self.take()
            while self.next != ")":
                parameter = self.take()
                if self.next == "(":  # w(start=…), where a simulation begins
                    self.take()
                    values[f"{parameter}.start"] = self.start()
                else:
                    self.take("=")
                    values[parameter] = self.value()
                if self.next != ")":
                    self.take(",")
            self.take(")")
        name = _untexted(self.take()) if self.next.startswith('"') else key
        self.take(";")
        unknown = next((one for one in values if one not in (*_PARAMETERS[place], START)), None)
        missing = next((one for one in _PARAMETERS[place] if one not in values), None)
        if unknown or missing:
            problem = "is not read" if unknown else "is missing"
            remedy = f"a {place.rpartition('.')[2]} has {', '.join(_PARAMETERS[place]) or 'no parameters'} here"
            raise InputError(problem, element=name, key=short(unknown or missing or "", 60), remedy=remedy)
        return _Component(place, key, values, name)

    def start(self) -> str:
        self.take("start")
        self.take("=")
        found = self.value()
        self.take(")")
        return found

    def value(self) -> str:
        found = ""
        while self.next not in (",", ")", ";", ""):
            found += self.take()
        return found

    @property
    def next(self) -> str:
        return self.words[self.at] if self.at < len(self.words) else ""

    def take(self, expected: str = "") -> str:
        word = self.next
        if not word or (expected and word != expected):
            raise self.wrong(word, expected)
        self.at += 1
        return word

    def wrong(self, word: str, expected: str = "") -> InputError:
        found = f"at {short(word, 40)}" if word else "at its end"
        wanted = f", where {expected} is expected" if expected else ""
        return InputError(f"is not a model of a line: cannot be read {found}{wanted}", key=self.source, remedy=_WRITTEN)


def _words(text: str, source: str) -> list[str]:
    found, at = [], 0
    while at < len(text):
        match = _TOKEN.match(text, at)
        if match is None:
            problem = f"is not a model of a line: cannot be read in line {text.count(chr(10), 0, at) + 1}"
            raise InputError(problem, key=source, remedy=_WRITTEN)
        if match.lastgroup:
            found.append(match.group())
        at = match.end()
    return found


def _untexted(word: str) -> str:
    return re.sub(r"\\(.)", r"\1", word[1:-1], flags=re.DOTALL)


def _flanges(components: list[_Component], joints: list[tuple[str, str]], source: str) -> dict[str, int]:
    """The flange of every port: both of an inertia are one, and so are those that are connected."""
    twice = next((key for key, count in Counter(one.key for one in components).items() if count > 1), None)
    if twice:
        raise InputError("is declared twice", element=source, key=short(twice, 60), remedy="rename one of them")
    over = {f"{one.key}.{port}": f"{one.key}.{port}" for one in components for port in _PORTS[one.kind]}

    def root(port: str) -> str:
        while over[port] != port:
            over[port] = over[over[port]]
            port = over[port]
        return port

    within = [(f"{one.key}.flange_a", f"{one.key}.flange_b") for one in components if one.kind == "Components.Inertia"]
    for first, other in [*within, *joints]:
        for port in (first, other):
            if port not in over:
                raise InputError("is not a flange of the model", element=source, key=short(port, 60), remedy=_WRITTEN)
        over[root(other)] = root(first)
    numbers: dict[str, int] = {}
    return {port: numbers.setdefault(root(port), len(numbers)) for port in over}


class _Made:
    """Items of a network from components; loads go to the inertia at their flange."""

    def __init__(self, name: str, components: list[_Component], flange: dict[str, int], source: str) -> None:
        self.name, self.components, self.flange, self.source = name, components, flange, source

    def network(self) -> Network:
        found = Network(self.name)
        grounds = {self.port(one, "flange"): one for one in self.of("Components.Fixed")}
        held = {self.port(one, end) for one in self.components for end in _PORTS[one.kind] if one.kind in _LEADING}
        for one in self.components:
            match one.kind:
                case "Components.Fixed" if self.port(one, "flange") in held:
                    found.items.append(FlangeDrive(one.name, self.port(one, "flange")))
                case "Sources.ConstantSpeed":
                    found.items.append(FlangeDrive(one.name, self.port(one, "flange"), self.number(one, "w_fixed")))
                case "Components.Inertia":
                    found.items.append(FlangeInertia(one.name, self.port(one, "flange_a"), self.number(one, "J")))
                case "Components.SpringDamper":
                    found.items.append(
                        FlangeSpring(one.name, *self.ends(one), self.number(one, "c"), self.number(one, "d"))
                    )
                case "Components.IdealGear":
                    found.items.append(FlangeGear(one.name, *self.ends(one), self.ratio(one)))
        self.add_loads(found, {at for at in grounds if at not in held})
        first = next(iter(self.of("Components.Inertia")), None)
        if first is not None and START in first.values and not found.of(FlangeDrive):
            found.speed = self.number(first, START)
        return found

    def add_loads(self, found: Network, grounds: set[int]) -> None:
        """Constant torques, and dampers to a ground, as loads of the inertias that they act on."""
        turning = _turning(found)
        for one in self.components:
            if one.kind == "Sources.ConstantTorque":
                sense = np.sign(turning.get(self.port(one, "flange"), 1.0))
                _load(
                    found,
                    one,
                    self.port(one, "flange"),
                    "load_torque",
                    float(-sense * self.number(one, "tau_constant")),
                )
            elif one.kind == "Components.Damper":
                near, far = self.ends(one)
                if far not in grounds:
                    remedy = "write a SpringDamper, or a Damper from an inertia to a Fixed of its own"
                    raise InputError(
                        "is a Damper between shafts, which lines do not have", element=one.name, remedy=remedy
                    )
                _load(found, one, near, "viscous_load", self.number(one, "d"))

    def of(self, kind: str) -> list[_Component]:
        return [one for one in self.components if one.kind == kind]

    def port(self, one: _Component, port: str) -> int:
        return self.flange[f"{one.key}.{port}"]

    def ends(self, one: _Component) -> tuple[int, int]:
        return self.port(one, "flange_a"), self.port(one, "flange_b")

    def number(self, one: _Component, key: str) -> float:
        try:
            found = float(one.values[key])
        except ValueError:
            found = math.nan
        if not math.isfinite(found):
            value = short(one.values[key], 40)
            raise InputError("is not a number", element=one.name, key=key, value=value, remedy="write 2.5 or 4e3, say")
        return found

    def ratio(self, one: _Component) -> Fraction:
        try:
            return read_ratio(one.values["ratio"])
        except (ValueError, ZeroDivisionError):
            value = short(one.values["ratio"], 40)
            remedy = "write 41/10 or 4.1, say, and not zero"
            raise InputError("is not a ratio", element=one.name, key="ratio", value=value, remedy=remedy) from None


_LEADING = ("Components.Inertia", "Components.SpringDamper", "Components.IdealGear")


def _turning(network: Network) -> dict[int, float]:
    """The mean speed of every flange over that of the first drive or inertia."""
    found = {next((one.at for kind in (FlangeDrive, FlangeInertia) for one in network.of(kind)), 0): 1.0}
    left = [one for one in network.items if isinstance(one, FlangeSpring | FlangeGear)]
    while joined := next((one for one in left if one.near in found or one.far in found), None):
        left.remove(joined)
        ratio = float(joined.ratio) if isinstance(joined, FlangeGear) else 1.0
        if joined.near in found:
            found.setdefault(joined.far, found[joined.near] / ratio)
        else:
            found[joined.near] = found[joined.far] * ratio
    return found


def _load(network: Network, one: _Component, at: int, key: str, value: float) -> None:
    from dataclasses import replace

    for place, item in enumerate(network.items):
        if isinstance(item, FlangeInertia) and item.at == at:
            network.items[place] = replace(item, **{key: getattr(item, key) + value})
            return
    raise InputError("acts on no inertia", element=one.name, remedy="connect it to an Inertia")
