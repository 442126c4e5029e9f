"""Many times kill -9, of workers, scheduler and client over one study: its data end as undisturbed ones.

``TRUNNION_KILLS=100`` makes a hundred of them, over a study that is as much longer.
"""

from __future__ import annotations

import os
import random
import signal
import socket
import subprocess
import sys
import time
from collections import Counter
from pathlib import Path

import pytest
from studies.asked import CALLS, data_of, line, stated

import trunnion as tn
from trunnion.studies.store import Store

KILLS = int(os.environ.get("TRUNNION_KILLS", "16"))
POINTS_A_KILL = 1000
"""More points than two workers finish until the next kill, so that the study outlasts all of them."""
ENOUGH = 240.0 + 60.0 * KILLS
"""Seconds after which the test fails instead of waiting."""
AUDIT = """
import os
from trunnion.studies.store import Store
def written(self, part, block, *rest, put=Store.put):
    put(self, part, block, *rest)
    with open(os.environ["AUDIT"], "a") as log:
        log.write(f"{part.number} {block}\\n")
if Store.put.__name__ == "put":  # a preload may be loaded twice
    Store.put = written
"""


def free_port() -> int:
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        return int(one.getsockname()[1])


class Cluster:
    """Scheduler, two workers and a client, each a process that is started again where it is gone."""

    def __init__(self, folder: Path, study: Path) -> None:
        self.port, self.folder, self.study = free_port(), folder, study
        (folder / "audit.py").write_text(AUDIT)
        source = str(Path(tn.__file__).parents[1])
        self.environment = {
            **os.environ, "PYTHONPATH": source, "AUDIT": str(folder / "audit.log"), "OMP_NUM_THREADS": "1",
            "OPENBLAS_NUM_THREADS": "1",
        }  # fmt: skip
        self.running: dict[str, subprocess.Popen[bytes]] = {}
        self.log = (folder / "log.txt").open("ab")

    def start(self, name: str) -> None:
        address = f"tcp://127.0.0.1:{self.port}"
        programs = {
            "scheduler": ["distributed.cli.dask_scheduler", "--host", "127.0.0.1", "--port", str(self.port),
                          "--no-dashboard"],
            "client": ["trunnion.cli", "study", str(self.study), "--scheduler", address],
        }  # fmt: skip
        worker = ["distributed.cli.dask_worker", address, "--nthreads", "1", "--no-nanny", "--no-dashboard",
                  "--preload", str(self.folder / "audit.py"), "--death-timeout", "60"]  # fmt: skip
        self.running[name] = subprocess.Popen(
            [sys.executable, "-m", *programs.get(name, worker)], cwd=self.folder, env=self.environment,
            stdout=self.log, stderr=self.log,
        )  # fmt: skip

    def keep(self) -> bool:
        """Start what is gone; whether the client has ended well."""
        client = self.running.get("client")
        if client is not None and client.poll() == 0:
            return True
        for name in ("scheduler", "worker 1", "worker 2", "client"):
            if name not in self.running or self.running[name].poll() is not None:
                self.start(name)
        return False

    def kill(self, name: str) -> None:
        os.kill(self.running[name].pid, signal.SIGKILL)
        self.running[name].wait()

    def end(self) -> None:
        for one in self.running.values():
            if one.poll() is None:
                one.kill()
                one.wait()
        self.log.close()


def written(path: Path, store: Path, calls: int) -> Path:
    import tomli_w

    tn.dump(line(), path.parent / "line.toml")
    asked = stated(store, CALLS, line="line.toml", block=calls)
    asked["parameter"][1]["points"] = KILLS * POINTS_A_KILL // 20
    asked["parameter"][0]["points"] = 20
    path.write_text(tomli_w.dumps(asked))
    return path


@pytest.mark.slow
def test_kills(tmp_path: Path) -> None:
    chance = random.Random(1)
    study = written(tmp_path / "study.toml", tmp_path / "killed.zarr", 128)
    cluster = Cluster(tmp_path, study)
    kills: Counter[str] = Counter()
    done, most_lost, moved, begun = 0, 0, False, time.monotonic()
    try:
        while not cluster.keep():
            assert time.monotonic() - begun < ENOUGH, f"{done} points after {ENOUGH:.0f} s and {kills}"
            time.sleep(chance.uniform(0.1, 2.0))
            if (tmp_path / "killed.zarr" / "study.json").is_file():
                counts = Store.open(tmp_path / "killed.zarr").counts()
                assert counts.done >= done, "what was done is lost"
                moved, done = moved or counts.done > done, counts.done
                assert counts.failed == 0
            # Something has to be at work to be killed: starting takes longer than a block.
            if moved and sum(kills.values()) < KILLS:
                name = chance.choices(["worker 1", "worker 2", "scheduler", "client"], [8, 8, 1, 2])[0]
                if cluster.running[name].poll() is None:
                    cluster.kill(name)
                    kills[name] += 1
                    moved = False
                    most_lost += 1 if name.startswith("worker") else 6
    finally:
        cluster.end()
    print(kills, f"{time.monotonic() - begun:.0f} s")
    audit = Counter((tmp_path / "audit.log").read_text().splitlines())
    repeated = sum(audit.values()) - len(audit)
    print(f"{repeated} blocks written twice of {len(audit)}")
    assert repeated <= most_lost
    whole = written(tmp_path / "whole.toml", tmp_path / "whole.zarr", 128)
    found = tn.study(whole, workers=2)
    assert found.outcome.ok and found.failed == 0
    assert data_of(tmp_path / "killed.zarr") == data_of(tmp_path / "whole.zarr")
    assert sum(kills.values()) >= KILLS, "the study ended before all kills were made: make it longer"
