"""How many tasks a second Dask's scheduler bears, by tasks that do nothing, and what tasks must take for more workers.

    python benchmarks/scheduler_load.py [tasks]

The sliding window is that of a study: three tasks a worker are sent ahead.
"""

from __future__ import annotations

import queue
import sys
from time import perf_counter, process_time

from trunnion.studies.runner import AHEAD, OF_SCHEDULER, workers_here

WORKERS = 2


def nothing(number: int) -> int:
    """The task."""
    return number


def main(tasks: int = 5000) -> None:
    """Send the tasks, and print what they cost."""
    with workers_here(WORKERS, dashboard=None) as client:
        client.gather(client.map(nothing, range(100), pure=False))
        arrived: queue.Queue[object] = queue.Queue()
        begun, processor, sent = perf_counter(), process_time(), 0
        flight: dict[object, object] = {}
        for _ in range(tasks):
            while sent < tasks and len(flight) < AHEAD * WORKERS:
                future = client.submit(nothing, sent, pure=False)
                flight[future.key] = future
                future.add_done_callback(lambda one: arrived.put(one.key))
                sent += 1
            flight.pop(arrived.get())
        seconds, used = perf_counter() - begun, process_time() - processor
    print(f"{tasks} empty tasks: {tasks / seconds:.0f} a second, {1e3 * used / tasks:.2f} ms of processor time each")
    for cores in (2, 16, 100, 1000):
        least, ours = cores * used / tasks, max(1.0, OF_SCHEDULER * cores)
        load = f"tasks of {ours:.0f} s load it to {100 * least / ours:.0f} %"
        print(f"{cores:5} workers keep busy with tasks of {least:.2g} s and more; {load}")


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
