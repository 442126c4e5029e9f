"""Runs a command until it begins to write, and from there again and again: killed at random moments, on a full disk.

One kill in three is SIGKILL, after which the next run sweeps; Ctrl-C and SIGTERM leave nothing to sweep.

A process of its own, since it forks and mounts: ``python interrupted.py KILLS SIZES SEED COMMAND…`` in a folder of its
own, whose sub-folder ``disk`` is the working folder of the command. It exits with 1 and a line for each
fault. Where no file system may be mounted the size of files is limited instead.
"""

from __future__ import annotations

import hashlib
import os
import random
import resource
import shutil
import signal
import subprocess
import sys
import time
import traceback
from collections.abc import Callable
from pathlib import Path

from trunnion import writing
from trunnion.cli import main as command
from trunnion.cli.ending import EndedBy

SIGNALS = (signal.SIGKILL, signal.SIGTERM, signal.SIGINT)
OLD = b"the old result"
ENDS = {".png": b"IEND\xaeB`\x82", ".html": b"</html>", ".csv": b"\n", ".toml": b"\n"}
MOUNT = ["mount", "-t", "tmpfs", "-o"]
FOUND = "what was found:"
LOG = Path("log").absolute()
DISK = Path("disk").absolute()
sweep = writing.sweep


def files() -> dict[str, bytes]:
    return {str(path): path.read_bytes() for path in sorted(Path().rglob("*")) if path.is_file()}


def whole(name: str, content: bytes) -> bool:
    if not name.endswith(".nc"):
        return content.endswith(ENDS[Path(name).suffix])
    body, label, checksum = content.rpartition(b"\ntrunnion sha256 ")
    return bool(label) and checksum == hashlib.sha256(body).hexdigest().encode() + b"\n"


def started() -> int:
    """A copy of this process, which hears signals as a command does; what it says is heard by the log alone."""
    signal.pthread_sigmask(signal.SIG_BLOCK, SIGNALS[1:])  # until it hears them
    child = os.fork()
    if not child:
        signal.signal(signal.SIGINT, signal.default_int_handler)  # as in the foreground
        EndedBy.hear()
        log = os.open(LOG, os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
        os.dup2(log, 1)
        os.dup2(log, 2)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, SIGNALS[1:])
    return child


def ended(child: int) -> int:
    return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])


class Trial:
    """What is done at the first moment of writing, in place of it."""

    def __init__(self, kills: int, sizes: int, seed: int, inputs: dict[str, bytes]) -> None:
        self.kills, self.sizes, self.random, self.inputs = kills, sizes, random.Random(seed), inputs
        self.faults: list[str] = []

    def __call__(self, folder: Path) -> None:
        writing.sweep = sweep
        begin = time.monotonic()
        child = started()
        if not child:
            return sweep(folder)
        if ended(child):
            self.faults.append(f"the command itself failed: {LOG.read_text()[-300:]}")
            self.leave()
        self.lasts = time.monotonic() - begin
        self.results = {name: content for name, content in files().items() if name not in self.inputs}
        if not self.results:
            self.faults.append("nothing was written")
        self.faults += [f"{name} is not whole" for name, content in self.results.items() if not whole(name, content)]
        needed = sum(len(content) // 4096 + 2 for content in self.results.values())
        self.reset()
        for k in range(self.kills):
            if not (child := started()):
                return sweep(folder)
            self.kill(child, self.random.uniform(0, self.lasts), SIGNALS[k % len(SIGNALS)])
        for k in range(self.sizes):
            self.reset()
            undone = limited(round(1.1 * needed * k / max(1, self.sizes - 1)))
            if not (child := started()):
                return sweep(folder)
            code = ended(child)
            undone()
            self.after_full_disk(code, f"room for {k} of {self.sizes - 1} parts")
        self.leave()
        raise AssertionError

    def reset(self) -> None:
        for name in self.results:
            Path(name).write_bytes(OLD)

    def kill(self, child: int, after: float, how: signal.Signals) -> None:
        time.sleep(after)
        os.kill(child, how)
        code = ended(child)
        where = f"{how.name} after {after:.4f} s"
        self.old_or_new(where)
        if how is not signal.SIGKILL:
            self.nothing_else(f"{where}, before the next run")
            if code not in (0, 128 + how):
                self.faults.append(f"{where}: code {code}, {LOG.read_text()[-300:]}")
        for folder in {Path(), *(Path(name).parent for name in self.results)}:
            with writing.written_whole(folder / "next.toml") as temporary:  # the next run
                temporary.write_bytes(b"\n")
            (folder / "next.toml").unlink()
        self.nothing_else(f"{where}, after the next run")
        self.reset()

    def after_full_disk(self, code: int, where: str) -> None:
        last = LOG.read_text().rstrip().rpartition("\n")[2]
        if code not in (0, 1, 2) or (code and not last.startswith("error: ")) or "Traceback" in LOG.read_text():
            self.faults.append(f"{where}: code {code}, {last[:300]}")
        self.old_or_new(where)
        self.nothing_else(where)
        if not code and OLD in files().values():
            self.faults.append(f"{where}: code 0, yet old results are left")

    def old_or_new(self, where: str) -> None:
        found = files()
        for name in self.results:
            if name not in found or not (found[name] == OLD or whole(name, found[name])):
                self.faults.append(f"{where}: {name} is neither old nor whole")

    def nothing_else(self, where: str) -> None:
        if left := set(files()) - set(self.results) - set(self.inputs):
            self.faults.append(f"{where}: left {sorted(left)}")

    def leave(self) -> None:
        # What the command itself has printed by then stands before.
        print(f"\n{FOUND}", "\n".join(self.faults) or "whole", sep="\n", flush=True)
        os._exit(bool(self.faults))


def limited(pages: int) -> Callable[[], None]:
    """Leave room for so many pages, and return how to undo it."""
    if not os.path.ismount(DISK):
        usual = resource.getrlimit(resource.RLIMIT_FSIZE)
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(resource.RLIMIT_FSIZE, (pages * 1024, usual[1]))
        return lambda: resource.setrlimit(resource.RLIMIT_FSIZE, usual)
    found = os.statvfs(DISK)
    remount(found.f_blocks - found.f_bfree + pages)
    return lambda: remount(found.f_blocks)


def remount(blocks: int) -> None:
    subprocess.run(["mount", "-o", f"remount,nr_blocks={max(blocks, 1)}", DISK], check=True)


def main() -> None:
    kills, sizes, seed = map(int, sys.argv[1:4])
    source = Path(sys.argv[0]).with_name("line.toml")
    DISK.mkdir()
    subprocess.run([*MOUNT, "nr_blocks=20000", "tmpfs", DISK], stderr=subprocess.DEVNULL)  # if it is allowed
    os.chdir(DISK)
    shutil.copy(source, "line.toml")
    Path("out").mkdir()
    writing.sweep = Trial(kills, sizes, seed, files())
    try:
        command(sys.argv[4:])
    except SystemExit as leave:
        os._exit(leave.code if isinstance(leave.code, int) else 3)
    except BaseException:
        traceback.print_exc()
    os._exit(3)


if __name__ == "__main__":
    try:
        main()
    except KeyboardInterrupt:  # while it was leaving already
        os._exit(EndedBy.code())
