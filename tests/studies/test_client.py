"""What is computed on the workers of a client is what is computed without, to the last bit."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import fields
from typing import Any

import distributed
import numpy as np
import pytest
from studies.asked import line

import trunnion as tn
from trunnion.numerics import workers as workers_module
from trunnion.numerics.chain import chain_monodromy
from trunnion.numerics.versions import computed_by
from trunnion.numerics.workers import Workers, workers_of_client
from trunnion.waiting import OutOfTime

GAP = tn.PiecewiseOscillator.gap(half_gap=1.0, damping=0.05, mean_force=0.2, force=0.4, frequency=0.7)
DUFFING = tn.reference_system("duffing")


@pytest.fixture(scope="module")
def client() -> Iterator[Any]:
    """Two workers that are threads of this process, which start at once."""
    with distributed.Client(
        processes=False, n_workers=2, threads_per_worker=1, dashboard_address=None, set_as_default=False
    ) as one:
        yield one


def same(first: Any, second: Any) -> list[str]:
    """Fields of two results that are not equal to the bit."""
    differ = []
    for one in fields(first):
        a, b = getattr(first, one.name), getattr(second, one.name)
        if isinstance(a, np.ndarray):
            if a.tobytes() != b.tobytes() or a.shape != b.shape or a.dtype != b.dtype:
                differ.append(one.name)
        elif isinstance(a, str | int | float | tuple) and repr(a) != repr(b):
            differ.append(one.name)
    return differ


def counted(monkeypatch) -> list[int]:
    """Numbers of tasks that were sent, call by call."""
    sent: list[int] = []
    each = Workers.each

    def counting(self, work, tasks):
        here = list(tasks)
        sent.append(len(here))
        return each(self, work, here)

    monkeypatch.setattr(Workers, "each", counting)
    return sent


def test_a_map_of_exponents(client, monkeypatch) -> None:
    """Exponents over two parameters, and all of them over one."""
    ask = lambda **more: tn.lyapunov_map(  # noqa: E731
        DUFFING, ("force", 0.1, 0.5, 5), ("frequency", 0.8, 1.2, 4), periods=20, transient=5, **more
    )
    sent = counted(monkeypatch)
    assert same(ask(), ask(client=client)) == [] and sent == [7]
    along = [
        tn.lyapunov_sweep(DUFFING, "force", (0.1, 0.5, 5), periods=20, transient=5, client=c) for c in (None, client)
    ]
    assert same(*along) == [] and len(sent) == 2


def test_basins(client, monkeypatch) -> None:
    x, v = np.linspace(-3, 3, 21), np.linspace(-1, 1, 15)
    sent = counted(monkeypatch)
    here, there = tn.basins(GAP, x, v), tn.basins(GAP, x, v, client=client)
    assert same(here, there) == [] and sent == [5] and len(here.attractors) >= 1
    assert [one.start.tobytes() for one in here.attractors] == [one.start.tobytes() for one in there.attractors]


@pytest.mark.parametrize("samples", [256, 1 << 16])
def test_a_tolerance_study(client, samples, monkeypatch) -> None:
    """Several speeds are several pieces, and so is one speed with more lines than go together."""
    speeds = [1.0, 1.1, 1.6] if samples == 256 else [1.6]
    asked = {"tolerances": {"Shaft *.stiffness": 0.1}, "speeds": speeds, "samples": samples}
    sent = counted(monkeypatch)
    loose = line().replace_all({"HookeJoint 1": {"angle": "30 deg"}})
    here, there = (tn.tolerance_study(loose, **asked, client=one) for one in (None, client))
    assert same(here, there) == [] and sent == [3 if samples == 256 else 2]
    assert here.worst == there.worst and 0 < here.probability < 1


@pytest.mark.slow
def test_checks_of_a_tolerance_study(client) -> None:
    limited = tn.catalogue("two-shaft-cardan")
    asked = {"tolerances": {"Shaft *.stiffness": 0.1}, "speeds": [1.4, 1.6], "samples": 256, "checks": 64}
    here, there = (tn.tolerance_study(limited, **asked, client=one) for one in (None, client))
    assert here.checks is not None and there.checks is not None
    assert [one for one in same(here.checks, there.checks) if one != "seconds"] == []


def test_a_chart(client, monkeypatch) -> None:
    """Blocks of lanes step as they do here: patches, slabs, spot checks and pixels are the same."""
    monkeypatch.setattr(chain_monodromy, "WORTH_SENDING", 0)
    sent = counted(monkeypatch)
    axes = ("speed", 0.5, 3.0, 40), ("HookeJoint 1.angle", 0.0, 0.7, 30)
    here = tn.stability_chart(line(), *axes)
    assert sent == []
    there = tn.stability_chart(line(), *axes, client=client)
    assert same(here, there) == [] and len(sent) >= 2 and here.spectral_radius.max() > 1
    points = [(one.at(1.234, 0.321).multipliers.tobytes()) for one in (here, there)]
    assert points[0] == points[1]


@pytest.mark.slow
def test_lines_with_more_terms_are_sent_too(client, monkeypatch) -> None:
    """Another kernel, and rows of numbers that all lanes share."""
    monkeypatch.setattr(chain_monodromy, "WORTH_SENDING", 0)
    loaded = line(load_torque=0.05)
    axes = ("speed", 1.0, 2.0, 7), ("Shaft 1.stiffness", 0.8, 1.2, 5)
    assert same(tn.stability_chart(loaded, *axes), tn.stability_chart(loaded, *axes, client=client)) == []


@pytest.mark.slow
def test_a_capture_map(client, monkeypatch) -> None:
    disks = tn.Disk(name="motor", inertia=1.0), tn.Disk(name="load", inertia=4.0)
    free = tn.Driveline([disks[0], tn.HookeJoint(angle="9 deg"), tn.Shaft(stiffness=2e3, damping=1.0), disks[1]])
    weak = tn.AppliedTorque(on="motor", time=[0], torque=[2.5], between="steps")
    angles, factors = ("HookeJoint 1.angle", 0.05, 0.18, 2), ("factor", 1.0, 4.0, 2)
    sent = counted(monkeypatch)
    here, there = (
        tn.capture_map(free, (15.0, 40.0), angles, factors, torque=[weak], phases=2, client=one)
        for one in (None, client)
    )
    assert same(here, there) == [] and sent == [1]


@pytest.mark.slow
def test_on_processes() -> None:
    """What is sent arrives read-only."""
    with (
        distributed.LocalCluster(
            n_workers=2, threads_per_worker=1, dashboard_address=None, host="127.0.0.1"
        ) as cluster,
        distributed.Client(cluster, set_as_default=False) as client,
    ):
        axes = ("speed", 0.5, 3.0, 300), ("HookeJoint 1.angle", 0.0, 0.7, 300)
        assert same(tn.stability_chart(line(), *axes), tn.stability_chart(line(), *axes, client=client)) == []
        x, v = np.linspace(-3, 3, 21), np.linspace(-1, 1, 15)
        assert same(tn.basins(GAP, x, v), tn.basins(GAP, x, v, client=client)) == []
        asked = {"tolerances": {"Shaft *.stiffness": 0.1}, "speeds": [1.0, 1.6], "samples": 1024}
        here, there = (tn.tolerance_study(line(), **asked, client=one) for one in (None, client))
        assert same(here, there) == []
        more = {"periods": 10, "transient": 2}
        maps = [tn.lyapunov_map(DUFFING, ("force", 0.1, 0.5, 3), ("frequency", 0.8, 1.2, 2), client=one, **more)
                for one in (None, client)]  # fmt: skip
        assert same(*maps) == []


def test_ends_in_its_time(client) -> None:
    """Nothing is known then, and nothing is left at work."""
    with pytest.raises(OutOfTime), tn.time_limit(1e-6):
        tn.basins(GAP, np.linspace(-3, 3, 21), np.linspace(-1, 1, 15), client=client)
    assert not client.futures


def test_what_is_no_client_is_refused(client, monkeypatch) -> None:
    with pytest.raises(tn.InputError, match=r"client = .str.: is not a client of Dask; give a distributed.Client"):
        tn.basins(GAP, [0.0], [0.0], client="tcp://far:1")
    ours = computed_by()
    with monkeypatch.context() as patch:
        patch.setattr(client, "run", lambda function, *rest: {"tcp://far:1": {**ours, "numpy": "1.0"}})
        with pytest.raises(tn.InputError, match=r"worker of other versions \(tcp://far:1: numpy 1\.0, here"):
            tn.basins(GAP, [0.0], [0.0], client=client)
    with monkeypatch.context() as patch:
        patch.setattr(client, "nthreads", dict)
        with pytest.raises(tn.InputError, match="client: has no workers; start some first"):
            tn.basins(GAP, [0.0], [0.0], client=client)
    assert workers_of_client(None) is None and workers_module.sharing() is None


def test_an_error_of_a_piece_is_the_error(client) -> None:
    """What a value of the line refuses is said as without."""
    with pytest.raises(tn.InputError) as here:
        tn.tolerance_study(line(), {"Shaft 1.stiffness": ("range", -1.0, 1.0)}, [1.0])
    with pytest.raises(tn.InputError) as there:
        tn.tolerance_study(line(), {"Shaft 1.stiffness": ("range", -1.0, 1.0)}, [1.0], client=client)
    assert str(here.value) == str(there.value)

    def fails(number: int) -> int:
        raise tn.ComputationError(f"no {number}")

    known = workers_of_client(client)
    assert known is not None
    with pytest.raises(tn.ComputationError, match="no 3"):
        list(known.each(fails, [3]))
    assert known.all(lambda number: number * number, range(20)) == [number * number for number in range(20)]
