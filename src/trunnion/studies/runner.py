"""Runs what is missing of a store on Dask, a few tasks ahead of the workers, and makes shards of what is done.

A task is some blocks, as many as take about a second by what blocks have taken so far: that changes what is sent
together, never what a block holds. Dask ends a task whose worker has died several times, and with it innocent ones
that were there by chance: these are run again alone, with a note of the point that is at work. One at which a process
dies twice is marked.
"""

from __future__ import annotations

import queue
from collections.abc import Callable, Iterator
from concurrent.futures import Future
from contextlib import contextmanager
from dataclasses import dataclass, field
from threading import Thread
from time import monotonic
from typing import Any

import numpy as np

from trunnion.errors import ComputationError, InputError, TrunnionError
from trunnion.studies.extra import scale
from trunnion.studies.parts import StudyPart
from trunnion.studies.points import FAILED
from trunnion.studies.store import PartState, Store
from trunnion.studies.task import Done, rows_of_deaths, run_alone, run_blocks, where_it_runs
from trunnion.waiting import time_is_up

TASK = 1.0
"""Seconds that a task should take, on few workers."""
OF_SCHEDULER = 0.01
"""The same for each worker, so that a scheduler that has some 600 tasks a second keeps up."""
AHEAD = 3
"""Tasks a worker that are sent."""
MOST_BLOCKS = 256
"""Blocks of a task."""
STARTED = 300.0
"""Seconds that a process of this machine may take to start."""
LATE = 45.0
"""Seconds after which a process of this machine that has not come back is replaced; twice as many each time, for it may
be the machine that is slow."""
REPLACED = 4
"""Times in turn that processes are replaced though no block was done in between."""
GONE = 180.0
"""Seconds without any worker after which nobody waits for one."""
ANSWER = 120.0
"""Seconds that the scheduler and the workers have to answer a question."""
PATIENCE = 0.5
"""Seconds between looks at whether to stop."""
ASKED_AFTER = 5.0
"""Seconds between questions who is there, each of which costs milliseconds."""
ATTEMPTS = 3
"""Times that a block is tried alone before its points are suspected one by one."""
CALLED = "10s"
"""How long a scheduler that is called may take to answer."""
LOST = "the scheduler has gone; all blocks that were done are kept: run the study again to resume"


@dataclass
class StudyProgress:
    """How far a run is: points in all, done at its start and since, failed, seconds, and what the workers hold."""

    points: int
    before: int
    done: int = 0
    failed: int = 0
    begun: float = field(default_factory=monotonic)
    workers: int = 0
    dashboard: str = ""
    measure: Callable[[], int] = int

    @property
    def share(self) -> float:
        """Done of all."""
        return (self.before + self.done) / max(self.points, 1)

    @property
    def rate(self) -> float:
        """Points a second since the start."""
        return self.done / max(monotonic() - self.begun, 1e-9)

    @property
    def left(self) -> float:
        """Seconds left at that rate; infinite before anything is known."""
        rest = self.points - self.before - self.done
        return rest / self.rate if self.done else float("inf")

    @property
    def bytes(self) -> int:
        """What all workers hold, asked now."""
        return self.measure()


Report = Callable[[StudyProgress], None]


@dataclass
class StudyRun:
    """One run over what a store lacks; ``client`` of Dask, or None to compute here."""

    store: Store
    client: Any
    report: Report
    cores: int = 1
    seconds_a_block: float = 0.0
    suspects: list[tuple[StudyPart, int]] = field(default_factory=list)
    own: bool = False
    last_seen: float = field(default_factory=monotonic)
    last_whole: float = field(default_factory=monotonic)
    last_asked: float = 0.0
    replaced: int = 0

    def __post_init__(self) -> None:
        self.states: dict[int, PartState] = {}
        self.progress = StudyProgress(0, 0)
        self.follow(self.store)

    def follow(self, store: Store) -> None:
        """Go on with the store as it is now, which may have further parts."""
        self.store = store
        for part in store.parts:
            if part.number in self.states:
                continue
            self.states[part.number] = store.state(part)
            self.progress.points += part.points
            there = (part.rows(block) for block in range(part.blocks) if self._has(part, block))
            self.progress.before += sum(last - first for first, last in there)

    def _has(self, part: StudyPart, block: int) -> bool:
        return self.states[part.number].has(part, block)

    def tasks(self) -> Iterator[tuple[StudyPart, tuple[int, ...]]]:
        """Missing blocks in turn, those that stand together as many as a task should have."""
        for part in self.store.parts:
            together: list[int] = []
            for block in range(part.blocks):
                if self._has(part, block):
                    continue
                if together and (block != together[-1] + 1 or len(together) >= self.blocks_a_task):
                    yield part, tuple(together)
                    together = []
                together.append(block)
            if together:
                yield part, tuple(together)

    @property
    def blocks_a_task(self) -> int:
        """By what blocks have taken so far."""
        if not self.seconds_a_block:
            return 1
        wanted = max(TASK, OF_SCHEDULER * self.cores)
        return int(np.clip(wanted / self.seconds_a_block, 1, MOST_BLOCKS))

    def all(self) -> str:
        """Run until nothing is missing, or a time limit ends it: why, or nothing.

        Raises
        ------
        ComputationError : the disk is full or fails, or the scheduler has gone.
        InputError : a worker has other versions, or does not see the store.
        """
        while True:
            self.compact_all()
            ended = self._here() if self.client is None else self._on_dask()
            if ended:
                return ended
            self.compact_all()
            if all(self._has(part, block) for part in self.store.parts for block in range(part.blocks)):
                return ""

    def compact_all(self) -> None:
        """Make every shard whose blocks are all done."""
        for part in self.store.parts:
            for shard in range(part.shards):
                self._compact(part, shard)

    def _compact(self, part: StudyPart, shard: int) -> None:
        state = self.states[part.number]
        blocks = part.blocks_of(shard)
        if shard in state.shards or not all(block in state.blocks for block in blocks):
            return
        damaged = self.store.compact(part, shard)
        state.blocks -= set(damaged if damaged else blocks)
        if not damaged:
            state.shards.add(shard)

    def finished(self, part: StudyPart, found: list[Done]) -> None:
        """Count blocks that are done, and make their shards where these are whole."""
        state = self.states[part.number]
        for block, points, failed, seconds in found:
            if self._has(part, block):
                continue
            if not self.store.block_path(part, block).is_file():
                shard = block // part.blocks_a_shard
                self.states[part.number] = state = self.store.state(part)
                if shard not in state.shards and block not in state.blocks:
                    path = str(self.store.path)
                    raise InputError("is not where the workers write", key="store", value=path,
                                     remedy="give a folder that all of them share")  # fmt: skip
            state.blocks.add(block)
            self.progress.done += points
            self.progress.failed += failed
            mine = self.seconds_a_block
            self.seconds_a_block = seconds if not mine else 0.8 * mine + 0.2 * seconds
        self.replaced = 0
        for shard in {block // part.blocks_a_shard for block, *_ in found}:
            self._compact(part, shard)
        self.report(self.progress)

    def _here(self) -> str:
        for part, blocks in self.tasks():
            for block in blocks:
                if ended := time_is_up():
                    return ended
                self.finished(part, run_blocks(str(self.store.path), self.store.identity, part.number, (block,)))
        return ""

    def _on_dask(self) -> str:
        arrived: queue.Queue[Any] = queue.Queue()
        flight: dict[str, tuple[Any, StudyPart, tuple[int, ...]]] = {}
        tasks = self.tasks()
        ended, more = "", True
        try:
            while flight or (more and not ended):
                while more and not ended and len(flight) < AHEAD * max(self.cores, 1):
                    task = next(tasks, None)
                    if task is None:
                        more = False
                        break
                    part, blocks = task
                    future = self._submit(run_blocks, part.number, blocks)
                    flight[future.key] = future, part, blocks
                    future.add_done_callback(arrived.put)
                if not flight:
                    break
                try:
                    future = arrived.get(timeout=PATIENCE)
                except queue.Empty:
                    self._require_scheduler(flight)
                    self._require_workers()
                    ended = ended or time_is_up()
                    if ended:
                        break
                    continue
                _, part, blocks = flight.pop(future.key)
                self._arrived(future, part, blocks)
                ended = ended or time_is_up()
                if ended:
                    break
        finally:
            if flight:
                self._cancel([future for future, *_ in flight.values()])
        if ended:
            return ended
        suspects, self.suspects = self.suspects, []
        for part, block in suspects:
            if ended := time_is_up():
                return ended
            if not self._has(part, block):
                self._alone(part, block)
        return ""

    def _submit(self, function: Callable[..., Any], *arguments: Any) -> Any:
        try:
            return self.client.submit(function, str(self.store.path), self.store.identity, *arguments, pure=False)
        except Exception as error:
            raise ComputationError(f"{LOST} ({type(error).__name__})") from None

    def _cancel(self, futures: list[Any]) -> None:
        try:
            answered(self.client.cancel, futures, force=True)
        except Exception:  # the scheduler is not there to be told
            return

    def _arrived(self, future: Any, part: StudyPart, blocks: tuple[int, ...]) -> None:
        if future.status == "finished":
            self.finished(part, future.result())
            return
        if future.status == "error":
            error = future.exception()
            if not isinstance(error, scale("distributed").scheduler.KilledWorker):
                raise _of_worker(error)
            self.suspects += [(part, block) for block in blocks]
            return
        raise ComputationError(LOST)

    def _require_scheduler(self, flight: dict[str, Any]) -> None:
        gone = self.client.status not in ("running", "newly-created")
        if gone or any(future.status in ("cancelled", "lost") for future, *_ in flight.values()):
            raise ComputationError(LOST)

    def _alone(self, part: StudyPart, block: int) -> None:
        """A block that was there when workers died, with nothing beside it. The points whose process dies twice at the
        same place are marked; what a block of a batch holds is computed together as ever, unless it dies alone too."""
        if self.store.question.batched:
            for _ in range(ATTEMPTS):
                future = self._submit(run_blocks, part.number, (block,))
                if not self._died(future):
                    self.finished(part, future.result())
                    return
        values, dead, begun = part.values(block), list[int](), monotonic()
        trace = self.store.folder(part) / f"alone-{block}.txt"
        seen = 0
        for _ in range(ATTEMPTS * len(values)):
            future = self._submit(run_alone, part.number, block, tuple(dead), str(trace))
            if not self._died(future):
                trace.unlink(missing_ok=True)
                found = future.result()
                self.store.put(part, block, values, found, monotonic() - begun)
                self.finished(part, [(block, len(values), int((found.status == FAILED).sum()), 0.0)])
                return
            rows = rows_of_deaths(trace)
            if len(rows) >= seen + 2 and rows[-1] == rows[-2] >= 0:
                dead.append(rows[-1])
                seen = len(rows)
        raise ComputationError("workers die again and again over no point in particular: look at their machine")

    def _died(self, future: Any) -> bool:
        """Whether the workers died that ran it; once it has ended."""
        distributed = scale("distributed")
        while True:
            try:
                future.result(timeout=PATIENCE)
                return False
            except (TimeoutError, distributed.TimeoutError):
                self._require_workers()
            except distributed.scheduler.KilledWorker:
                return True
            except distributed.CancelledError:
                raise ComputationError(LOST) from None
            except Exception as error:
                raise _of_worker(error) from None

    def _require_workers(self) -> None:
        """Refuse to wait for workers that do not come back.

        Raises
        ------
        ComputationError : there has been none for ``GONE`` seconds, or the scheduler has gone.
        """
        if self.client.status not in ("running", "newly-created"):
            raise ComputationError(LOST)
        if monotonic() - self.last_asked < ASKED_AFTER:
            return
        self.last_asked = monotonic()
        try:
            alive = answered(self.client.nthreads)
        except Exception as error:
            raise ComputationError(f"{LOST} ({type(error).__name__})") from None
        if len(alive) >= self.cores:
            self.last_whole = monotonic()
        elif self.own and monotonic() - self.last_whole > LATE * 2**self.replaced:
            self._replace_lost(set(alive))
        if alive:
            self.last_seen = monotonic()
        elif monotonic() - self.last_seen > GONE:
            raise ComputationError(f"no workers are left for {GONE:.0f} s; what is done is kept: resume")

    def _replace_lost(self, alive: set[str]) -> None:
        """Start others for processes of this machine that died before their keeper knew that they had begun: Dask
        forgets these.

        Raises
        ------
        ComputationError : those before did not come either.
        """
        if self.replaced >= REPLACED:
            why = f"processes of this machine do not start, though they were replaced {REPLACED} times"
            raise ComputationError(f"{why}; what is done is kept: run the study again with fewer workers")
        self.replaced += 1
        cluster = self.client.cluster
        lost = [name for name, one in cluster.workers.items() if getattr(one, "worker_address", None) not in alive]
        if lost:
            cluster.sync(cluster.scale_down, lost, callback_timeout=ANSWER)
        cluster.scale(self.cores)
        self.last_whole = monotonic()


def _of_worker(error: BaseException) -> Exception:
    if isinstance(error, TrunnionError):
        return error
    if isinstance(error, OSError):
        return ComputationError(f"a worker cannot write ({error.strerror or error}); what is done is kept: resume")
    return ComputationError(f"a worker failed: {type(error).__name__}: {error}; what is done is kept: resume")


def answered(question: Callable[..., Any], *arguments: Any, **more: Any) -> Any:
    """What Dask answers to a call that itself has no time limit.

    Raises
    ------
    TimeoutError : nothing within ``ANSWER`` seconds.
    """
    reply: Future[Any] = Future()

    def ask() -> None:
        try:
            reply.set_result(question(*arguments, **more))
        except BaseException as error:
            reply.set_exception(error)

    Thread(target=ask, daemon=True, name="asks Dask").start()
    return reply.result(ANSWER)


def memory_of(client: Any) -> int:
    """Bytes that all workers hold; 0 where the scheduler does not say, which is not a reason to end a study."""
    try:
        workers = answered(client.scheduler_info, n_workers=-1)["workers"].values()
    except (OSError, TimeoutError):
        return 0
    return sum(int(one["metrics"].get("memory", 0)) for one in workers if one.get("metrics"))


def require_workers(client: Any, store: Store, scheduler: str) -> int:
    """How many threads there are, once every worker has the same versions and sees the store.

    Raises
    ------
    InputError : one does not.
    """
    from trunnion.numerics.versions import computed_by

    try:
        client.wait_for_workers(1, timeout=30)
        versions = answered(client.run, computed_by)
        places = answered(client.run, where_it_runs, str(store.path))
    except ModuleNotFoundError as error:
        raise InputError(f"has a worker without {error.name}", key="scheduler", value=scheduler,
                         remedy="install this version of Trunnion with [scale] there") from None  # fmt: skip
    except TimeoutError:
        raise InputError("has no workers that answer", key="scheduler", value=scheduler,
                         remedy="start some first") from None  # fmt: skip
    except OSError as error:
        raise ComputationError(f"a worker ended before it had begun ({type(error).__name__}): run it again") from None
    ours = computed_by()
    for worker, theirs in versions.items():
        differ = [f"{key} {theirs.get(key)}, here {ours[key]}" for key in ours if theirs.get(key) != ours[key]]
        if differ:
            raise InputError(f"has a worker of other versions ({worker}: {'; '.join(differ)})", key="scheduler",
                             value=scheduler, remedy="install the same versions there")  # fmt: skip
    if not all(seen for seen, _ in places.values()):
        raise InputError("is not where the workers write", key="store", value=str(store.path),
                         remedy="give a folder that all of them share")  # fmt: skip
    return sum(client.nthreads().values())


@contextmanager
def workers_here(processes: int, memory: str | float | None = None, dashboard: int | None = 0) -> Iterator[Any]:
    """A client of processes of this machine, of one thread each, that nobody else reaches; its page too.

    Raises
    ------
    ComputationError : they do not start.
    """
    dask, distributed = scale("dask"), scale("distributed")
    settings = {
        "distributed.scheduler.allowed-failures": 1,
        "distributed.worker.daemon": True,
        # What Dask does by the clock takes some 5 % of a processor by default, more than all else beside the points.
        "distributed.worker.profile.enabled": False,
        "distributed.admin.tick.interval": "1s",
        "distributed.admin.tick.limit": "1h",
        "distributed.admin.system-monitor.interval": "10s",
        "distributed.worker.memory.monitor-interval": "250ms",
        "distributed.scheduler.active-memory-manager.start": False,
        "distributed.scheduler.worker-saturation": 1.1,
        "distributed.nanny.pre-spawn-environ": {
            "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "MKL_NUM_THREADS": "1", "NUMBA_NUM_THREADS": "1",
            "MALLOC_TRIM_THRESHOLD_": "65536",
        },
        "distributed.logging": {"distributed": "critical"},
    }  # fmt: skip
    page = None if dashboard is None else f"127.0.0.1:{dashboard}"
    with (
        dask.config.set(settings),
        _quiet(),
        distributed.LocalCluster(
            n_workers=0, threads_per_worker=1, processes=True, host="127.0.0.1", dashboard_address=page,
            memory_limit=memory or "auto", silence_logs=50, death_timeout=STARTED,
        ) as cluster,
        distributed.Client(cluster, set_as_default=False) as client,
    ):  # fmt: skip
        cluster.scale(processes)
        try:
            client.wait_for_workers(processes, timeout=STARTED)
        except TimeoutError:
            why = f"{processes} processes of this machine do not start within {STARTED:.0f} s"
            raise ComputationError(f"{why}; ask for fewer workers, or 0 to compute here") from None
        yield client


@contextmanager
def workers_of(scheduler: str) -> Iterator[Any]:
    """A client of a scheduler by its address.

    Raises
    ------
    InputError : nothing answers there.
    """
    distributed = scale("distributed")
    try:
        client = distributed.Client(scheduler, timeout=CALLED, set_as_default=False)
    except (OSError, ValueError, TimeoutError) as error:
        why = "answers nothing" if isinstance(error, OSError | TimeoutError) else f"is not an address ({error})"
        raise InputError(why, key="scheduler", value=scheduler,
                         remedy='write "tcp://host:8786", and start it with: dask scheduler') from None  # fmt: skip
    with client, _quiet():
        yield client


@contextmanager
def _quiet() -> Iterator[None]:
    """Workers that die and return are told of in the progress, not in the log."""
    import logging

    names = ("distributed", "distributed.nanny", "distributed.scheduler", "distributed.worker", "distributed.client")
    loggers = [logging.getLogger(name) for name in names]
    before = [one.level for one in loggers]
    for one in loggers:
        one.setLevel(logging.CRITICAL)
    try:
        yield
    finally:
        for one, level in zip(loggers, before, strict=True):
            one.setLevel(level)
