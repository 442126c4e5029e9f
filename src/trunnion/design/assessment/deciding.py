"""What a verdict rests on: each rule as the application and the file have it, by the table ``driveline.rules.RULES``.

A rule that decides is left as it is; one that is shown keeps its numbers, and the verdict does not rest on it; of one
that does not apply, or that the file switches off, a single line is left that says why.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace

from trunnion.design.assessment.check import Check, Status
from trunnion.driveline.operation import Operation
from trunnion.driveline.rules import APPLICATIONS, RULES, Weight


def weighed(checks: Iterable[Check], operation: Operation | None) -> Iterator[Check]:
    """Checks as they count for a line that runs so."""
    application = operation.application if operation else None
    off = {one.rule: f"switched off: {one.reason}" for one in operation.switched_off} if operation else {}
    said: set[str] = set()
    for check in checks:
        name = check.rule.name
        weight = RULES[name].weight(application)
        why = off.get(name) or (f"not made for {APPLICATIONS[application or '']}" if weight is Weight.FOREIGN else "")
        if not why:
            yield check if weight is Weight.DECIDES else replace(check, decides=False)
        elif name not in said:
            said.add(name)
            yield Check(name, Status.NOT_APPLICABLE, check.rule, why)
