"""Microseconds per task of Dask: an empty function, results gathered in memory, nothing durable."""

import sys
import time

import distributed

TASKS = 5000


def nothing(x):
    return x


def main():
    print("| threads | tasks | microseconds per task |\n|---|---|---|")
    for threads in (1, 2, 4):
        with distributed.LocalCluster(
            n_workers=1, threads_per_worker=threads, processes=True, dashboard_address=None
        ) as cluster, distributed.Client(cluster) as client:
            client.gather(client.map(nothing, range(100), key="warm"))
            started = time.perf_counter()
            values = client.gather(client.map(nothing, range(TASKS), key="task"))
            each = 1e6 * (time.perf_counter() - started) / TASKS
            assert values == list(range(TASKS))
        print(f"| {threads} | {TASKS} | {each:.0f} |", flush=True)
    print(f"Dask {distributed.__version__}, Python {sys.version.split()[0]}")


if __name__ == "__main__":
    main()
