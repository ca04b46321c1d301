"""The paper's two algorithms and Total Edge in Python and numpy, as a baseline to envgen.

Prints nanoseconds per cell at 256^2 and 1000^2; compare with `cargo bench -p envgen --bench
landscape` on the same machine. Needs numpy.
"""

import time

import numpy as np


def geometric_counts(cells, classes, beta):
    weights = beta ** np.arange(classes)
    counts = np.floor(cells * weights / weights.sum()).astype(int)
    counts[0] += cells - counts.sum()
    return counts


def random_fill(counts, rng):
    cells = np.repeat(np.arange(1, len(counts) + 1, dtype=np.uint16), counts)
    rng.shuffle(cells)
    return cells


def automaton_fill(rows, cols, counts, epsilon, rng):
    left = list(counts)
    cells = np.zeros((rows, cols), dtype=np.uint16)
    current = int(rng.integers(len(left)))
    for r in range(rows):
        for c in range(cols) if r % 2 == 0 else range(cols - 1, -1, -1):
            if left[current] == 0 or rng.random() < epsilon:
                others = [k for k, n in enumerate(left) if n > 0 and k != current]
                if others:
                    current = others[int(rng.integers(len(others)))]
            left[current] -= 1
            cells[r, c] = current + 1
    return cells


def total_edge(cells):
    across = np.count_nonzero(cells[:, 1:] != cells[:, :-1])
    return across + np.count_nonzero(cells[1:] != cells[:-1])


def best(task, turns=3):
    times = []
    for _ in range(turns):
        start = time.perf_counter()
        task()
        times.append(time.perf_counter() - start)
    return min(times)


def main():
    rng = np.random.default_rng(1)
    for side in (256, 1000):
        n = side * side
        counts = geometric_counts(n, 9, 0.72)
        cells = random_fill(counts, rng).reshape(side, side)
        for name, task in (
            ("random filling", lambda: random_fill(counts, rng)),
            ("automaton", lambda: automaton_fill(side, side, counts, 0.1, rng)),
            ("Total Edge", lambda: total_edge(cells)),
        ):
            print(f"{name:<16}{side:>6}^2 {best(task) / n * 1e9:>12.2f} ns a cell")


if __name__ == "__main__":
    main()
