#!/usr/bin/env python3
"""Flies the sweeps shipped_weights and retrained_weights and prints the table of docs/sweeps.md.

    docs/figures/make_retraining_table.py build/release/bin/windhover [--trainings N] [--jobs N]

From the root of the repository; needs python3-yaml. Each cell: Abs Rel with the shipped weights,
with those of the rig itself; the mean difference of flights of one seed with its 95 % interval
(Student's t); in brackets the least and the largest mean of N trainings, each with data of its own.
"""

import argparse
import concurrent.futures
import csv
import math
import pathlib
import statistics
import subprocess
import sys
import tempfile

import yaml

SCENARIOS = pathlib.Path("scenarios").resolve()
METHODS = ["pcm", "joint_mlp", "fused"]
T975_OF_29 = 2.045  # 30 seeds.


class Bench:
    def __init__(self, program, jobs):
        self.program, self.jobs = program, jobs
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="retraining_"))
        text = (SCENARIOS / "sweeps/shipped_weights.yaml").read_text()
        self.sweep = yaml.safe_load(text.replace("../", f"{SCENARIOS}/"))

    def windhover(self, *words):
        done = subprocess.run([self.program, *map(str, words)], capture_output=True, text=True)
        if done.returncode != 0:
            sys.exit(f"windhover {' '.join(map(str, words))}: {done.stderr}")

    def fly(self, name, file, jobs):
        """The rows of a sweep's table by point."""
        self.windhover("sweep", file, "--out", self.folder / name, "--jobs", jobs)
        points = {}
        with open(self.folder / name / "table.csv") as table:
            for row in csv.DictReader(table):
                points.setdefault(int(row["point"]), []).append(row)
        return points

    def shipped_sweep(self, name):
        return self.fly(name, SCENARIOS / f"sweeps/{name}.yaml", self.jobs)

    def another_training(self, seed, point, changes):
        """The rows of a point with weights that other data and another seed give."""
        name = f"seed{seed}_point{point}"
        scenario, file = self.folder / f"{name}.scenario.yaml", self.folder / f"{name}.yaml"
        card = self.folder / f"{name}.json"
        base = {"extends": self.sweep["base"], **self.sweep["set"]}
        scenario.write_text(yaml.safe_dump(base))
        sets = [word for key, value in changes.items() for word in ("--set", f"{key}={value}")]
        self.windhover("train", "pcm", scenario, "--out", card, "--data-seed", seed,
                       "--seed", seed, *sets)
        held = {"estimator.correction": str(card), **changes}
        factors = [{"key": key, "values": [value]} for key, value in held.items()]
        file.write_text(yaml.safe_dump({**self.sweep, "factors": factors,
                                        "design": {"type": "grid"}}))
        return self.fly(name, file, 1)[0]


def changes_of(row, nominal, keys):
    return {key: row[key] for key in keys if row[key] != nominal[key]}


def errors(rows, method):
    return [float(row[f"methods.{method}.abs_rel"]) for row in rows]


def cell(shipped, retrained, others, method):
    a, b = errors(shipped, method), errors(retrained, method)
    differences = [y - x for x, y in zip(a, b)]
    half = T975_OF_29 * statistics.stdev(differences) / math.sqrt(len(differences))
    means = [statistics.mean(errors(rows, method)) for rows in [retrained, *others]]
    return (f"{statistics.mean(a):.3f}, {means[0]:.3f}; {statistics.mean(differences):+.3f} "
            f"± {half:.3f} ({min(means):.3f}–{max(means):.3f})").replace("-", "−")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program")
    parser.add_argument("--trainings", type=int, default=4)
    parser.add_argument("--jobs", type=int, default=2)
    given = parser.parse_args()
    bench = Bench(given.program, given.jobs)
    shipped = bench.shipped_sweep("shipped_weights")
    retrained = bench.shipped_sweep("retrained_weights")
    keys = [factor["key"] for factor in bench.sweep["factors"]]
    changes = {point: changes_of(rows[0], shipped[0][0], keys) for point, rows in shipped.items()}
    with concurrent.futures.ThreadPoolExecutor(given.jobs) as pool:
        others = {point: [pool.submit(bench.another_training, seed, point, changes[point])
                          for seed in range(2, given.trainings + 1)] for point in shipped}
        print("| | baseline | " + " | ".join(METHODS) + " |\n" + "|---" * (len(METHODS) + 2) + "|")
        for point, rows in shipped.items():
            name = ", ".join(f"{k} {v}" for k, v in changes[point].items()) or "the card's own rig"
            found = [one.result() for one in others[point]]
            cells = [cell(rows, retrained[point], found, method) for method in METHODS]
            baseline = statistics.mean(errors(rows, "baseline"))
            print(f"| {name} | {baseline:.2f} | " + " | ".join(cells) + " |", flush=True)


if __name__ == "__main__":
    main()
