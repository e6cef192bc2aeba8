"""Where samples run: processes of this machine, or a Dask cluster. A worker that dies takes no sample with it.

Samples that were under way when a process died are run again one by one, so that the one that ends processes is known.
"""

from __future__ import annotations

import logging
import os
from collections import deque
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Executor, Future, wait
from contextlib import AbstractContextManager, contextmanager
from pathlib import Path

from .distributions import StudyError
from .sample import Sample, Task, run_sample
from .varied import Settings

Job = tuple[int, Settings]
"""Number of a sample, and its settings."""
Pool = Callable[[int], AbstractContextManager[Executor]]
"""Opens so many workers."""
_AHEAD = 2
"""Samples handed out to each worker, so that none waits."""
ANSWER = 10.0
"""s within which the scheduler of a cluster must answer."""
_STDERR = 2
_ONE_THREAD: Mapping[str, str] = dict.fromkeys(
    ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1"
)


def carried_out(task: Task, jobs: Sequence[Job], workers: int, pool: Pool) -> Iterator[Sample]:
    """Samples as they are finished, in any order; CancelledError where a cluster has lost its scheduler."""
    waiting, suspects = deque(jobs), deque[Job]()
    while waiting:
        yield from _until_one_dies(task, waiting, workers, _AHEAD * workers, pool, suspects)
        while suspects:
            dead = deque[Job]()
            yield from _until_one_dies(task, suspects, 1, 1, pool, dead)
            for index, _ in dead:
                yield Sample(
                    index, "the process that ran it died, twice; the system may have run out of memory"
                )


def _until_one_dies(
    task: Task, queue: deque[Job], workers: int, ahead: int, pool: Pool, lost: deque[Job]
) -> Iterator[Sample]:
    """Samples until the queue is empty or a worker dies, which leaves those under way, at most `ahead`, in `lost`."""
    under_way: dict[Future[Sample], Job] = {}
    with pool(workers) as executor:
        try:
            while queue or under_way:
                while queue and len(under_way) < ahead:
                    job = queue.popleft()
                    under_way[_submitted(executor, task, job)] = job
                for future in wait(under_way, return_when=FIRST_COMPLETED).done:
                    error = future.exception()
                    if isinstance(error, BrokenExecutor):
                        raise error
                    index, _ = under_way.pop(future)
                    # one sample that fails in an unforeseen way, or ends workers of a cluster, must not end the rest
                    yield (
                        future.result()
                        if error is None
                        else Sample(index, f"{type(error).__name__}: {error}")
                    )
        except BrokenExecutor:
            # what had finished before is not lost
            for future, job in under_way.items():
                if future.done() and future.exception() is None:
                    yield future.result()
                else:
                    lost.append(job)


def _submitted(executor: Executor, task: Task, job: Job) -> Future[Sample]:
    try:
        return executor.submit(run_sample, task, *job)
    except BrokenExecutor as error:
        failed: Future[Sample] = Future()
        failed.set_exception(error)
        return failed


@contextmanager
def local(workers: int) -> Iterator[Executor]:
    """Processes of this machine, each with one thread; they end with what is run in them where that is interrupted."""
    from loky import ProcessPoolExecutor

    _start_tracker_silently()
    executor = ProcessPoolExecutor(workers, env=dict(_ONE_THREAD))
    finished = False
    try:
        yield executor
        finished = True
    finally:
        executor.shutdown(wait=True, kill_workers=not finished)


def _start_tracker_silently() -> None:
    """Start loky's tracker of semaphores with no terminal: after kills it prints leaks that it cleans up itself."""
    from loky.backend import resource_tracker

    kept = os.dup(_STDERR)
    try:
        with Path(os.devnull).open("w") as nowhere:
            os.dup2(nowhere.fileno(), _STDERR)
            resource_tracker.ensure_running()
    finally:
        os.dup2(kept, _STDERR)
        os.close(kept)


def dask(address: str) -> Pool:
    """The workers of a Dask cluster, whose scheduler has this address; StudyError where it is not there."""
    try:
        from distributed import Client
    except ImportError:
        raise StudyError("a cluster needs Dask, which is not installed: pip install '.[cluster]'") from None

    @contextmanager
    def cluster(_: int) -> Iterator[Executor]:
        try:
            client = Client(address, timeout=ANSWER)
        except (OSError, ValueError) as error:
            raise StudyError(f"{address}: no Dask scheduler answers there ({error})") from None
        log = logging.getLogger(
            "distributed.client"
        )  # it logs tracebacks of what the study says in a sentence
        level = log.level
        log.setLevel(logging.CRITICAL + 1)
        try:
            with client:
                yield client.get_executor(pure=False)
        finally:
            log.setLevel(level)

    return cluster
