#!/usr/bin/env python3
"""Prints the table of images_beside_boxes in docs/sweeps.md.

    windhover sweep scenarios/sweeps/images_beside_boxes.yaml --out DIR
    docs/figures/compare_boxes_images.py DIR/table.csv

Flights with boxes and with images are paired by point and seed. A difference is the mean over
points of a point's mean over seeds, with its 95 % interval over points (Student's t, that of many).
"""

import csv
import math
import statistics
import sys

METRICS = {
    "methods.baseline.by_distance.30.abs_rel": "Abs Rel of `baseline`, 30 to 35 m",
    "methods.baseline.abs_rel": "Abs Rel of `baseline`, all that is found",
    "methods.baseline.detected": "frames found",
    "methods.size.abs_rel": "Abs Rel of `size`",
}
T975 = 2.01  # 48 points.


def pairs_of(file):
    """{rig: {seed: {observe: row}}}"""
    rigs = {}
    with open(file) as table:
        for row in csv.DictReader(table):
            rig = (row["flex.section"], row["rig.focal_mm"], row["vibration.level"])
            rigs.setdefault(rig, {}).setdefault(row["seed"], {})[row["observe"]] = row
    return rigs


def line(rigs, metric):
    """Means of boxes and images over points, difference, half its interval, points."""
    points = []
    for seeds in rigs.values():
        both = [(float(one["geometric"][metric]), float(one["image"][metric])) for one in seeds.values()
                if len(one) == 2 and one["geometric"][metric] and one["image"][metric]]
        if both:
            points.append([statistics.fmean(side) for side in zip(*both)])
    boxes, images = (statistics.fmean(side) for side in zip(*points))
    differences = [image - box for box, image in points]
    half = T975 * statistics.stdev(differences) / math.sqrt(len(points))
    return boxes, images, statistics.fmean(differences), half, len(points)


def main():
    rigs = pairs_of(sys.argv[1])
    print("| | boxes | images | difference, 95 % over points |\n|---|---|---|---|")
    for metric, name in METRICS.items():
        boxes, images, difference, half, n = line(rigs, metric)
        digits = 0 if metric.endswith("detected") else 3
        print(f"| {name} ({n} points) | {boxes:.{digits}f} | {images:.{digits}f} |"
              f" {difference:+.{digits}f} ± {half:.{digits}f} |")


main()
