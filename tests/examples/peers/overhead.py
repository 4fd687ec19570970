"""Microseconds per task of Dask and of HyperQueue without the work. Dask: an empty function, results gathered in memory. HyperQueue:
the program `true`, since its tasks are processes; no output. Neither keeps anything durable."""

import contextlib
import os
import sys
import tempfile
import time

import distributed
import hyperqueue
from hyperqueue.cluster import LocalCluster, WorkerConfig

TASKS = 5000


def nothing(x):
    return x


def dask(slots):
    with distributed.LocalCluster(
        n_workers=1, threads_per_worker=slots, processes=True, dashboard_address=None
    ) as cluster, distributed.Client(cluster) as client:
        client.gather(client.map(nothing, range(100), key="warm"))
        started = time.perf_counter()
        values = client.gather(client.map(nothing, range(TASKS), key="task"))
        each = 1e6 * (time.perf_counter() - started) / TASKS
        assert values == list(range(TASKS))
    return each


@contextlib.contextmanager
def quiet():
    """HyperQueue prints its server's table and a progress bar from native code."""
    kept = [os.dup(1), os.dup(2)]
    null = os.open(os.devnull, os.O_WRONLY)
    os.dup2(null, 1), os.dup2(null, 2)
    try:
        yield
    finally:
        os.dup2(kept[0], 1), os.dup2(kept[1], 2)
        for descriptor in (*kept, null):
            os.close(descriptor)


def queue(slots):
    with tempfile.TemporaryDirectory() as folder, quiet():
        with LocalCluster(worker_config=WorkerConfig(cores=slots)) as cluster:
            client = cluster.client()
            for tasks in (100, TASKS):
                job = hyperqueue.Job(default_workdir=folder)
                for _ in range(tasks):
                    job.program(["/bin/true"], stdout=None, stderr=None)
                started = time.perf_counter()
                assert client.wait_for_jobs([client.submit(job)])
                each = 1e6 * (time.perf_counter() - started) / TASKS
    return each


def main():
    print("| program | slots | tasks | microseconds per task |\n|---|---|---|---|")
    for slots in (1, 2, 4):
        print(f"| Dask {distributed.__version__} | {slots} | {TASKS} | {dask(slots):.0f} |", flush=True)
    for slots in (1, 2, 4):
        print(f"| HyperQueue | {slots} | {TASKS} | {queue(slots):.0f} |", flush=True)
    print(f"Python {sys.version.split()[0]}")


if __name__ == "__main__":
    main()
