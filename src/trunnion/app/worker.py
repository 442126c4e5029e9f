"""A process that computes: reads jobs from its standard input, answers on its standard output.

It ends with the server, whose end of the pipe closes. Results stay here, the last few of each function, so that a
picture, a file or another set of pixels of what is on screen computes nothing anew.
"""

from __future__ import annotations

import os
import queue
import shutil
import signal
import sys
import threading
import warnings
from collections import OrderedDict, defaultdict
from collections.abc import Callable
from typing import IO, Any

from trunnion.app.parts.calls import FOLDERS
from trunnion.app.parts.jobs import CUT_OFF, Job, Request, WorkerMessage, receive, send
from trunnion.errors import InputError, InputRemark, TrunnionError

GROWING = ("tn.read_study",)
"""Functions that may give something else every time, so that nothing of them is kept."""
MOST_KEPT = 4
"""Results of a function that stay: a coarse and a full chart of two variants."""


class _JobCancelled(Exception):
    """The job is not wanted any more."""


class WorkerLoop:
    def __init__(self, inward: IO[bytes], outward: IO[bytes], threads: int) -> None:
        self.inward, self.outward, self.threads = inward, outward, threads
        self.jobs: queue.Queue[tuple[int, Job]] = queue.Queue()
        self.stopped: set[int] = set()
        self.kept: defaultdict[str, OrderedDict[str, Any]] = defaultdict(OrderedDict)

    def run(self) -> None:
        threading.Thread(target=self._listen, daemon=True).start()
        while True:
            send(self.outward, self._answer(*self.jobs.get()))

    def _listen(self) -> None:
        while True:
            try:
                request: Request = receive(self.inward)
            except CUT_OFF:
                for folder in FOLDERS:
                    shutil.rmtree(folder, ignore_errors=True)
                os._exit(0)  # the server has gone, whatever is being computed
            if request.job is None:
                self.stopped.add(request.number)
            else:
                self.jobs.put((request.number, request.job))

    def _answer(self, number: int, job: Job) -> WorkerMessage:
        with warnings.catch_warnings(record=True) as said:
            warnings.simplefilter("always", InputRemark)
            try:
                value = self.compute(job, self._progress(number))
            except _JobCancelled:
                return WorkerMessage(number, "stopped", "stopped")
            except InputError as error:
                return WorkerMessage(number, "refused", str(error))
            except TrunnionError as error:
                return WorkerMessage(number, "failed", str(error))
            except MemoryError:
                return WorkerMessage(number, "failed", "not enough memory; ask for fewer points")
            except Exception as error:
                return WorkerMessage(number, "failed", f"unexpected {type(error).__name__}: {error}")
        remarks = dict.fromkeys(str(w.message) for w in said if issubclass(w.category, InputRemark))
        return WorkerMessage(number, "done", value, tuple(remarks))

    def _progress(self, number: int) -> Callable[[float], None]:
        def report(share: float) -> None:
            if number in self.stopped:
                self.stopped.discard(number)
                raise _JobCancelled
            send(self.outward, WorkerMessage(number, "progress", float(share)))

        return report

    def compute(self, job: Job, progress: Callable[[float], None]) -> Any:
        from trunnion.app import shown

        progress(0.0)
        result = self._result(job, progress)
        return getattr(shown, job.show)(result, **job.options)

    def _result(self, job: Job, progress: Callable[[float], None]) -> Any:
        from trunnion.driveline.files import loads

        key, kept = repr((job.toml, job.call)), self.kept[job.call.function]
        if key in kept:
            kept.move_to_end(key)
            return kept[key]
        result = job.call.evaluate(loads(job.toml), {"progress": progress, "threads": self.threads})
        if job.call.function in GROWING:
            return result
        kept[key] = result
        while len(kept) > MOST_KEPT:
            kept.popitem(last=False)
        return result


def main() -> None:
    """Entry of ``python -m trunnion.app.worker THREADS``."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is the server's, which closes the pipe
    outward = os.fdopen(os.dup(sys.stdout.fileno()), "wb")
    os.dup2(sys.stderr.fileno(), sys.stdout.fileno())  # whatever prints must not mix with the answers
    WorkerLoop(sys.stdin.buffer, outward, int(sys.argv[1])).run()


if __name__ == "__main__":
    main()
