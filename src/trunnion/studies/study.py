"""``study``: one analysis at very many points, on all processors or a cluster, kept so that nothing is lost."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from contextlib import AbstractContextManager, nullcontext
from pathlib import Path
from typing import Any

from trunnion.driveline.arguments import whole_number
from trunnion.driveline.driveline import Driveline
from trunnion.errors import InputError
from trunnion.studies.cost import StudyCost, cost_of
from trunnion.studies.description import StudyPlan, as_description, plan_of, read_description
from trunnion.studies.result import Study, read
from trunnion.studies.rounds import BoundarySearch, asked_of
from trunnion.studies.runner import StudyProgress, StudyRun, memory_of, require_workers, workers_here, workers_of
from trunnion.studies.store import Store
from trunnion.waiting import keeps_time


@keeps_time
def study(
    stated: str | os.PathLike[str] | Mapping[str, Any],
    *,
    line: Driveline | None = None,
    workers: int | None = None,
    scheduler: str | None = None,
    client: Any = None,
    memory: str | None = None,
    verify: bool = False,
    tables_anywhere: bool = False,
    within: float | None = None,
    progress: Callable[[StudyProgress], None] | None = None,
) -> Study:
    """Ask an analysis at very many points of a line, and keep every answer; what is there is not computed again.

    Parameters
    ----------
    stated : the study: path of its TOML file, or the same as a mapping, whose paths start from the working folder.
    line : the line, instead of the file that the study names.
    workers : processes of this machine, of one thread each; by default as many as processors; 0 computes here.
    scheduler : instead, the address of a Dask scheduler whose workers see the store ("tcp://host:8786").
    client : instead, a ``distributed.Client`` of yours.
    memory : that a process of this machine may take ("2 GiB"); one that takes more is ended, and its point is marked.
    verify : first read everything back that is there, and compute anew what is damaged.
    tables_anywhere : as of ``load``, of the line.
    within : seconds after which it ends with what it has.
    progress : called as progress(state), a ``StudyProgress`` with share, rate, failures and memory.

    Returns
    -------
    Study: the points with their quantities.

    Raises
    ------
    InputError : what is wrong in the study, or a store of another one; the extra is not installed; no scheduler.
    ComputationError : the disk is full, or the scheduler has gone; what is done is kept.

    Examples
    --------
    >>> import trunnion as tn
    >>> shaft = tn.Shaft(stiffness=1e4, damping=2.0)
    >>> line = tn.Driveline([tn.ConstantSpeed(), tn.HookeJoint(angle=0.1), shaft, tn.Disk(inertia=0.8)])
    >>> angle = {"path": "HookeJoint 1.angle", "low": "2 deg", "high": "20 deg", "points": 10}
    >>> speed = {"path": "speed", "low": "300 rpm", "high": "2400 rpm", "points": 50}
    >>> asked = {"line": "", "analysis": "stability", "quantities": ["growth_rate", "verdict"], "store": "angles.zarr"}
    >>> tn.study_cost({**asked, "parameter": [angle, speed]}, line=line).points
    500
    """
    if sum(one is not None for one in (workers, scheduler, client)) > 1:
        raise InputError("are two ways to compute", key="workers and scheduler", remedy="give one")
    if workers is not None:
        whole_number(workers, "workers", 0)
    plan = _plan(stated, line, tables_anywhere)
    processes = (os.cpu_count() or 1) if workers is None else workers
    store = Store.create(plan.store, plan.question, plan.design, plan.block, plan.source, plan.refinement)
    store = store.extended(plan.design, plan.block, plan.refinement, plan.design.shape)
    search = BoundarySearch(plan.refinement, plan.design) if plan.refinement else None
    ended = completed(store, processes, scheduler, client, memory, verify, progress, search)
    return read(Store.open(store.path), None if search else plan.design, ended, search)


def resumed(
    path: str | os.PathLike[str],
    *,
    workers: int | None = None,
    scheduler: str | None = None,
    memory: str | None = None,
    verify: bool = False,
    progress: Callable[[StudyProgress], None] | None = None,
) -> Study:
    """Compute what a store lacks, as ``study`` does, from what the store itself says."""
    store = Store.open(Path(path))
    store.require_version()
    processes = (os.cpu_count() or 1) if workers is None else workers
    _, refinement, first = asked_of(store)
    search = BoundarySearch(refinement, first) if refinement else None
    ended = completed(store, processes, scheduler, None, memory, verify, progress, search)
    return read(Store.open(store.path), None, ended, search)


def completed(
    store: Store, processes: int, scheduler: str | None, client: Any, memory: str | None, verify: bool,
    progress: Callable[[StudyProgress], None] | None, search: BoundarySearch | None = None,
) -> str:  # fmt: skip
    """Compute what a store lacks, and what a ``search`` for a boundary asks for then; why it ended before all was done,
    or nothing."""
    store.path = store.path.absolute()
    if verify:
        store.verify()
    store.tidy()
    report = progress or (lambda state: None)
    run = StudyRun(store, None, report)
    run.compact_all()
    if run.progress.before == run.progress.points:
        more, ended = _further(run, search)
        if not more:
            return ended
    ways: AbstractContextManager[Any]
    if client is not None:
        ways = nullcontext(client)
    elif scheduler is not None:
        ways = workers_of(scheduler)
    elif processes:
        ways = workers_here(processes, memory)
    else:
        return _through(run, search)
    with ways as connected:
        run.client, run.own = connected, client is None and scheduler is None
        run.cores = require_workers(connected, store, scheduler or "here")
        run.progress.dashboard = connected.dashboard_link or ""
        run.progress.workers = run.cores
        run.progress.measure = lambda: memory_of(connected)
        return _through(run, search)


def _through(run: StudyRun, search: BoundarySearch | None) -> str:
    """Compute what is missing, and what is asked for then, until there is nothing."""
    while True:
        if ended := run.all():
            return ended
        more, ended = _further(run, search)
        if not more:
            return ended


def _further(run: StudyRun, search: BoundarySearch | None) -> tuple[bool, str]:
    """Whether a search asks for more points, which the run then has; or why it ended early."""
    if search is None:
        return False, ""
    store, ended = search.next_round(run.store)
    more = store is not run.store
    run.follow(store)
    return more, ended


def study_cost(
    stated: str | os.PathLike[str] | Mapping[str, Any],
    *,
    line: Driveline | None = None,
    workers: int | None = None,
    tables_anywhere: bool = False,
) -> StudyCost:
    """What a study would cost, from a few points that are computed: nothing is kept, and the extra is not needed.

    Parameters
    ----------
    stated, line, tables_anywhere : as of ``study``.
    workers : that would share the work; by default as many as this machine has processors.

    Examples
    --------
    >>> import trunnion as tn
    >>> shaft = tn.Shaft(stiffness=1e4, damping=2.0)
    >>> line = tn.Driveline([tn.ConstantSpeed(), tn.HookeJoint(angle=0.1), shaft, tn.Disk(inertia=0.8)])
    >>> angle = {"path": "HookeJoint 1.angle", "low": "2 deg", "high": "20 deg", "points": 1000}
    >>> asked = {"line": "", "analysis": "natural_frequencies", "quantities": "damping_ratio.max", "store": "a.zarr"}
    >>> tn.study_cost({**asked, "parameter": [angle]}, line=line).blocks
    1
    """
    plan = _plan(stated, line, tables_anywhere)
    return cost_of(plan, whole_number(workers or os.cpu_count() or 1, "workers", 1))


def _plan(
    stated: str | os.PathLike[str] | Mapping[str, Any], line: Driveline | None, tables_anywhere: bool
) -> StudyPlan:
    if isinstance(stated, Mapping):
        return plan_of(as_description(stated), Path(), line, "a mapping", tables_anywhere=tables_anywhere)
    described, folder = read_description(stated)
    return plan_of(described, folder, line, Path(stated).name, tables_anywhere=tables_anywhere)
