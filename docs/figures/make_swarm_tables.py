#!/usr/bin/env python3
"""Flies the paired experiments of docs/swarm.md and prints their tables as Markdown.

    docs/figures/make_swarm_tables.py build/release/bin/windhover [TABLE...] [--seeds N] [--jobs N]

From the root of the repository. TABLE: truth, offset, vibration, focal, aircraft, images; all but images if
none is given. Every row is a set of flights of the seeds 1 to N; the first row of a group is what the
others are compared with by `windhover compare`: in brackets the 95 % interval of the difference of
pairs of one seed; none where no pair differs.
"""

import argparse
import concurrent.futures
import json
import math
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

SCENARIOS = pathlib.Path("scenarios").resolve()
COLUMNS = ["collisions", "near_misses", "min_separation_m", "order", "false_brakes",
           "missed_brakes"]
BY_METHOD = ["baseline", "pcm", "fused"]
GUARDED = ["swarm.guard.enabled=true"]


class Bench:
    """Flies rows of tables in a folder of its own, which it empties."""

    def __init__(self, program, seeds, jobs):
        self.program, self.seeds = program, seeds
        self.pool = concurrent.futures.ThreadPoolExecutor(jobs)
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="swarm_tables_"))

    def windhover(self, *words):
        done = subprocess.run([self.program, *map(str, words)], capture_output=True, text=True)
        if done.returncode not in (0, 1):  # 1: a gate of the scenario failed, which is no concern.
            sys.exit(f"windhover {' '.join(map(str, words))}: {done.stderr}")
        return done.stdout

    def scenario(self, name, text):
        file = self.folder / f"{name}.yaml"
        file.write_text(text)
        return file

    def train(self, scenario, overrides):
        """A card of corrections for the scenario's rig, with its second aircraft as target."""
        file = self.folder / f"trained_{len(list(self.folder.glob('trained_*.json')))}"
        resolved = self.windhover("check", scenario, "--resolved", *sets(overrides))
        self.scenario(file.name, resolved)
        self.windhover("train", "pcm", f"{file}.yaml", "--out", f"{file}.json")
        return f"{file}.json"

    def fly(self, name, scenario, overrides):
        """The folder of a row's flights."""
        row = self.folder / name
        def one(seed):
            self.windhover("run", scenario, "--seed", seed, "--out", row / str(seed), "--no-report",
                           *sets(overrides))
        list(self.pool.map(one, range(1, self.seeds + 1)))
        return row

    def compared(self, first, other):
        metrics = json.loads(self.windhover("compare", first, other, "--json"))["runs"]
        if other != first:
            shutil.rmtree(other)
        return {one["metric"]: one for one in metrics}

    def group(self, title, scenario, rows):
        """Prints one line for each (name, overrides) of rows; compares while the next row flies."""
        first = self.fly("first", scenario, rows[0][1])
        compared = [self.pool.submit(self.compared, first,
                                     self.fly(f"other_{i}", scenario, overrides))
                    for i, (_, overrides) in enumerate(rows[1:])]
        found = [one.result() for one in compared or [self.pool.submit(self.compared, first, first)]]
        print_row(title, rows[0][0], {metric: {"b": one["a"], "ci95": None}
                                      for metric, one in found[0].items()})
        for (name, _), metrics in zip(rows[1:], found):
            print_row(title, name, metrics)
        shutil.rmtree(first)


def sets(overrides):
    return [word for one in overrides for word in ("--set", one)]


def print_header():
    print("| scenario | row | " + " | ".join(COLUMNS) + " |")
    print("|" + "---|" * (len(COLUMNS) + 2), flush=True)


def print_row(title, name, found):
    cells = []
    for column in COLUMNS:
        one = found.get(f"swarm.{column}")
        if one is None:
            cells.append("–")
        elif not one["ci95"] or one["ci95"] == [0, 0]:
            cells.append(f"{one['b']:.3g}")
        else:
            low, high = one["ci95"]
            cells.append(f"{one['b']:.3g} [{low:+.2g}, {high:+.2g}]")
    print(f"| {title} | {name} | " + " | ".join(cells) + " |", flush=True)


def on_rig(name, preset):
    """A shipped scenario, flown with the rig and the estimators of a preset."""
    text = (SCENARIOS / f"{name}.yaml").read_text()
    return re.sub(r"^extends: .*", f"extends: {SCENARIOS}/presets/{preset}.yaml", text,
                  flags=re.MULTILINE)


def ring(n):
    """flock_6 with n aircraft 6 m apart, which settle where those across are at 7/8 of that ring."""
    radius_m = 3 / math.sin(math.pi / n)
    cohesion = 9.6 / (7 / 8 * 2 * radius_m)**2
    aircraft = "".join(
        f"  - {{id: {i}, type: p600, carries_rig: true, controller: swarm, position_m: "
        f"[{radius_m * math.cos(at):.3f}, {radius_m * math.sin(at):.3f}, 20], "
        f"yaw_deg: {math.degrees(at) - 180:.1f}}}\n"
        for i, at in enumerate(2 * math.pi * k / n for k in range(n)))
    text = on_rig("flock_6", "uavde_12mm")
    text = re.sub(r"^aircraft:\n(  - .*\n)*", "aircraft:\n" + aircraft, text, flags=re.MULTILINE)
    return text.replace("cohesion_per_s: 0.05", f"cohesion_per_s: {cohesion:.4f}")


def loop(method, card=None):
    """Overrides that let a method fly; 'truth': exact ranges."""
    if method == "truth":
        return ["observe=truth", "estimator.methods=[baseline]", "estimator.in_loop=baseline"]
    return ["observe=geometric", f"estimator.methods=[{method}]", f"estimator.in_loop={method}"] + (
        [f"estimator.correction={card}"] if card else [])


def methods_rows(bench, scenario, overrides, methods=BY_METHOD):
    card = bench.train(scenario, ["observe=geometric", *overrides])
    return [(method, overrides + loop(method, card)) for method in ["truth", *methods]]


def truth_table(bench):
    for name in ["flock_6", "head_on_swarm", "crossing_pair"]:
        bench.group(name, SCENARIOS / f"{name}.yaml", [("truth", [])])


FLOWN = [("crossing_pair", GUARDED), ("head_on_swarm", []), ("flock_6", GUARDED)]


def titled(name, guard):
    return f"{name}, guarded" if guard and name == "head_on_swarm" else name


def offset_table(bench):
    """Measured disparities too large, where distances seem smaller, and too small."""
    for offset_px in [70, 20, -20, -70]:
        rig = [f"rig.misalignment.offset_px={offset_px}",
               f"rig.misalignment.yaw_deg={math.copysign(0.05, offset_px)}"]
        for name, guard in [*FLOWN, ("head_on_swarm", GUARDED)]:
            scenario = bench.scenario("offset", on_rig(name, "uavde_12mm"))
            bench.group(f"{titled(name, guard)}, {offset_px:+} px", scenario,
                        methods_rows(bench, scenario, rig + guard))


def vibration_table(bench):
    for preset, method in [("calibrated", "baseline"), ("uavde_12mm", "fused")]:
        for name, guard in FLOWN:
            scenario = bench.scenario("vibration", on_rig(name, preset))
            card = bench.train(scenario, ["observe=geometric"]) if method == "fused" else None
            rows = [(f"{method}, {level} ×",
                     [f"vibration.level={level}", *guard, *loop(method, card)])
                    for level in [0, 1, 3]]
            bench.group(f"{titled(name, guard)}, {preset}", scenario, rows)


def focal_table(bench):
    for focal_mm in [8, 12, 16, 25]:
        for name, guard in FLOWN:
            scenario = bench.scenario("focal", on_rig(name, "uavde_12mm"))
            bench.group(f"{titled(name, guard)}, {focal_mm} mm", scenario,
                        methods_rows(bench, scenario, [f"rig.focal_mm={focal_mm}", *guard],
                                     ["fused"]))


def aircraft_table(bench):
    for n in [2, 5, 10, 15, 20]:
        scenario = bench.scenario("ring", ring(n))
        bench.group(f"ring of {n}", scenario,
                    methods_rows(bench, scenario, [], ["baseline", "fused"]))


def images_table(bench):
    """Boxes without pixels beside boxes that the detector finds in images."""
    for name, guard in [("crossing_pair", GUARDED), ("head_on_swarm", [])]:
        scenario = bench.scenario("images", on_rig(name, "calibrated"))
        rows = [(observe, [f"observe={observe}", "render.rasteriser=native", *guard])
                for observe in ["truth", "geometric", "image"]]
        bench.group(titled(name, guard), scenario, rows)


TABLES = {"truth": truth_table, "offset": offset_table, "vibration": vibration_table,
          "focal": focal_table, "aircraft": aircraft_table, "images": images_table}


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("program", type=lambda p: str(pathlib.Path(p).resolve()))
    parser.add_argument("tables", nargs="*", default=[t for t in TABLES if t != "images"])
    parser.add_argument("--seeds", type=int, default=100)
    parser.add_argument("--jobs", type=int, default=2)
    options = parser.parse_intermixed_args()
    for unknown in set(options.tables) - set(TABLES):
        parser.error(f"TABLE must be one of {', '.join(TABLES)} (found {unknown})")
    bench = Bench(options.program, options.seeds, options.jobs)
    for name in options.tables:
        print(f"\n{name}, {options.seeds} seeds\n")
        print_header()
        TABLES[name](bench)
    shutil.rmtree(bench.folder)


if __name__ == "__main__":
    main()
