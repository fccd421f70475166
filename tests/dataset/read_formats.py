"""Reads a data set as the programs of its format do, and checks every field against the format's
published description; says what is wrong and exits 1. Takes FORMAT FOLDER.

Sources: COCO's "Data format" and "Results format" pages; Ultralytics' "Object detection datasets";
KITTI's object development kit (readme.txt); "The EuRoC micro aerial vehicle datasets" and its
sensor.yaml files; Kalibr's wiki, "YAML formats" and "Bag format"; the authors' reading of UAVDE.
"""

import csv
import glob
import json
import math
import os
import struct
import sys

import numpy as np
import pandas as pd
import yaml


def require(condition, *what):
    if not condition:
        raise SystemExit("wrong: " + " ".join(str(each) for each in what))


def size_of(image):
    with open(image, "rb") as file:
        data = file.read()
    if data[:8] == b"\x89PNG\r\n\x1a\n":
        return struct.unpack(">II", data[16:24])
    require(data[:2] == b"\xff\xd8" and data[-2:] == b"\xff\xd9", image, "is no whole JPEG")
    at = 2
    while data[at + 1] not in (0xC0, 0xC1, 0xC2):
        at += 2 + struct.unpack(">H", data[at + 2 : at + 4])[0]
    height, width = struct.unpack(">HH", data[at + 5 : at + 9])
    return width, height


def coco(folder):
    boxes = 0
    for file in sorted(glob.glob(folder + "/annotations/instances_*.json")):
        split = os.path.basename(file)[len("instances_") : -len(".json")]
        with open(file) as opened:
            data = json.load(opened)
        require({"info", "licenses", "images", "annotations", "categories"} <= set(data), file)
        categories = {c["id"] for c in data["categories"]}
        images = {image["id"]: image for image in data["images"]}
        require(len(images) == len(data["images"]), "ids of images must differ")
        for image in images.values():
            size = size_of(os.path.join(folder, split, image["file_name"]))
            require(size == (image["width"], image["height"]), image, size)
        ids = [annotation["id"] for annotation in data["annotations"]]
        require(len(set(ids)) == len(ids), "ids of annotations must differ")
        for annotation in data["annotations"]:
            image = images[annotation["image_id"]]
            require(annotation["category_id"] in categories and annotation["iscrowd"] in (0, 1))
            x, y, w, h = annotation["bbox"]
            require(w > 0 and h > 0 and x >= 0 and y >= 0, annotation["bbox"])
            require(x + w <= image["width"] and y + h <= image["height"], annotation["bbox"])
            mask = annotation["segmentation"]
            require(mask["size"] == [image["height"], image["width"]], mask["size"])
            # Runs of zeros and ones in turn, down the columns.
            values = np.arange(len(mask["counts"])) % 2
            pixels = np.repeat(values, mask["counts"])
            require(pixels.size == image["width"] * image["height"], "runs", pixels.size)
            require(pixels.sum() == annotation["area"], "area", annotation["area"])
            pixels = pixels.reshape(image["width"], image["height"]).T
            rows, columns = np.nonzero(pixels)
            if len(rows):
                require(columns.min() >= x - 1 and columns.max() <= x + w, "mask leaves its box")
                require(rows.min() >= y - 1 and rows.max() <= y + h, "mask leaves its box")
            require(annotation["attributes"]["distance_m"] > 0)
            boxes += 1
    return boxes


def yolo(folder):
    with open(folder + "/data.yaml") as opened:
        about = yaml.safe_load(opened)
    require(about["nc"] == len(about["names"]), about)
    boxes = 0
    for split in ("train", "val", "test"):
        images = sorted(glob.glob(os.path.join(folder, about[split], "*.jpg")))
        require(images, split, "has no images")
        for image in images:
            size_of(image)
            label = image.replace("/images/", "/labels/").rsplit(".", 1)[0] + ".txt"
            rows = [line.split() for line in open(label)]
            require(len(set(map(tuple, rows))) == len(rows), label, "repeats a row")
            for row in rows:
                require(len(row) == 5 and int(row[0]) < about["nc"], label, row)
                x, y, w, h = map(float, row[1:])
                require(min(x - w / 2, y - h / 2) > -1e-6, label, row)
                require(max(x + w / 2, y + h / 2) < 1 + 1e-6 and w > 0 and h > 0, label, row)
                boxes += 1
    return boxes


def kitti(folder):
    boxes = 0
    named = sum((open(f).read().split() for f in glob.glob(folder + "/ImageSets/*.txt")), [])
    require(len(set(named)) == len(named), "splits share frames")
    for name in named:
        base = folder + "/training/"
        size = size_of(f"{base}image_2/{name}.png")
        require(size == size_of(f"{base}image_3/{name}.png"))
        calibration = {}
        for line in open(f"{base}calib/{name}.txt"):
            key, values = line.split(":")
            calibration[key] = np.array(values.split(), float)
        P2, P3 = (calibration[key].reshape(3, 4) for key in ("P2", "P3"))
        require(calibration["R0_rect"].size == 9 and calibration["Tr_velo_to_cam"].size == 12)
        require(P3[0, 3] < P2[0, 3], "the right camera must be on the right")
        for line in open(f"{base}label_2/{name}.txt"):
            fields = line.split()
            require(len(fields) == 15, name, "must have 15 columns", line)
            truncated, occluded, alpha, x0, y0, x1, y1, h, w, l, x, y, z, ry = map(float, fields[1:])
            require(0 <= truncated <= 1 and occluded in (0, 1, 2, 3), line)
            require(abs(alpha) <= math.pi + 1e-6 and abs(ry) <= math.pi + 1e-6, line)
            require(-1 <= x0 <= x1 <= size[0] and -1 <= y0 <= y1 <= size[1], line)
            # alpha is the yaw as seen along the line of sight.
            turned = math.remainder(ry - math.atan2(x, z) - alpha, 2 * math.pi)
            require(abs(turned) < 1e-3, name, "alpha", turned)
            # The corners of its box in space, seen by P2, are around its box in the image, but for
            # the rig's own errors: some tens of px.
            c, s = math.cos(ry), math.sin(ry)
            corners = [
                (x + c * a * l / 2 + s * b * w / 2, y - d * h, z - s * a * l / 2 + c * b * w / 2, 1)
                for a in (-1, 1) for b in (-1, 1) for d in (0, 1)
            ]
            seen = P2 @ np.array(corners).T
            u = seen[0] / seen[2]
            if truncated == 0:
                wide = u.max() - u.min()
                require(0.4 * wide < x1 - x0 < 1.15 * wide + 2, name, "width", x1 - x0, wide)
                require(abs((u.max() + u.min()) - (x0 + x1)) / 2 < 0.15 * size[0], name, "place")
            boxes += 1
    return boxes


def rigid(values):
    T = np.array(values, float).reshape(4, 4)
    require(np.allclose(T[3], [0, 0, 0, 1]) and np.allclose(T[:3, :3] @ T[:3, :3].T, np.eye(3)))
    require(np.linalg.det(T[:3, :3]) > 0)
    return T


def euroc(folder):
    pairs = 0
    for mav in sorted(glob.glob(folder + "/*/mav0")):
        poses = []
        for camera in ("cam0", "cam1"):
            with open(f"{mav}/{camera}/sensor.yaml") as opened:
                about = yaml.safe_load(opened)
            require(about["sensor_type"] == "camera" and about["camera_model"] == "pinhole")
            require(about["distortion_model"] in ("radial-tangential", "equidistant"))
            require(len(about["intrinsics"]) == len(about["distortion_coefficients"]) == 4)
            poses.append(rigid(about["T_BS"]["data"]))
            rows = list(csv.reader(open(f"{mav}/{camera}/data.csv")))
            require(rows[0] == ["#timestamp [ns]", "filename"], rows[0])
            stamps = [int(row[0]) for row in rows[1:]]
            require(stamps == sorted(set(stamps)), camera, "stamps must rise")
            for row in rows[1:]:
                require(size_of(f"{mav}/{camera}/data/{row[1]}") == tuple(about["resolution"]))
                require(row[1] == row[0] + ".png")
            pairs += len(stamps)
        # cam1 is right of cam0, in cam0's axes.
        between = np.linalg.inv(poses[0]) @ poses[1]
        require(between[0, 3] > 0.01 and abs(between[1, 3]) < 1e-3, between)
        imu = pd.read_csv(mav + "/imu0/data.csv")
        require(imu.shape[1] == 7 and imu.columns[0] == "#timestamp [ns]", imu.columns)
        require((np.diff(imu.iloc[:, 0]) > 0).all() and np.isfinite(imu.to_numpy()).all())
        truth = pd.read_csv(mav + "/state_groundtruth_estimate0/data.csv")
        require(truth.shape[1] == 17, truth.columns)
        norm = (truth.iloc[:, 4:8] ** 2).sum(axis=1)
        require(np.allclose(norm, 1, atol=1e-6), "quaternions")
        require(imu.iloc[0, 0] <= stamps[0] and stamps[-1] <= imu.iloc[-1, 0] + 10**9)
    return pairs


def kalibr(folder):
    pairs = 0
    for file in sorted(glob.glob(folder + "/*/camchain.yaml")):
        with open(file) as opened:
            chain = yaml.safe_load(opened)
        for name in ("cam0", "cam1"):
            camera = chain[name]
            require(camera["camera_model"] == "pinhole" and len(camera["intrinsics"]) == 4)
            require(camera["distortion_model"] in ("radtan", "equidistant"))
            require(len(camera["distortion_coeffs"]) == 4 and camera["rostopic"].startswith("/"))
            rigid(camera["T_cam_imu"])
            images = sorted(glob.glob(os.path.join(os.path.dirname(file), name, "*.png")))
            for image in images:
                require(size_of(image) == tuple(camera["resolution"]))
                require(int(os.path.basename(image)[:-4]) >= 10**18, "names must be nanoseconds")
            pairs += len(images)
        # T_cn_cnm1 takes cam0's coordinates to cam1's: through the IMU as well.
        through = rigid(chain["cam1"]["T_cam_imu"]) @ np.linalg.inv(rigid(chain["cam0"]["T_cam_imu"]))
        require(np.allclose(through, rigid(chain["cam1"]["T_cn_cnm1"]), atol=1e-9), through)
        imu = pd.read_csv(os.path.join(os.path.dirname(file), "imu0.csv"))
        require(list(imu.columns) == ["timestamp", "omega_x", "omega_y", "omega_z", "alpha_x",
                                      "alpha_y", "alpha_z"], imu.columns)
    return pairs


def tum(folder):
    poses = 0
    for file in glob.glob(folder + "/*/*.tum"):
        rows = np.loadtxt(file, ndmin=2)
        require(rows.shape[1] == 8 and (np.diff(rows[:, 0]) > 0).all(), file)
        require(np.allclose((rows[:, 4:] ** 2).sum(axis=1), 1, atol=1e-6), file)
        poses += len(rows)
    return poses


def uavde(folder):
    """As the authors' code: ids without a side, which goes before the last field between dashes;
    the last row of the detections; distances by the left image's name."""
    frames = 0
    for split in ("train", "val", "test"):
        base = f"{folder}/data/{split}"
        distances = pd.read_csv(base + "/annotations.csv", index_col=0)
        numbers = np.load(base + ".npy", allow_pickle=True)
        lines = open(base + "_no_prefix.txt").readlines()
        require(len(lines) == len(numbers), split)
        for line, entry in zip(lines, numbers):
            require(entry["file_id"] == line and line.endswith(".txt\n"), line)
            parts = line.strip().split("-")
            for side in ("Left", "Right"):
                name = "-".join(parts[:-1] + [side, parts[-1]])
                size_of(f"{base}/image/{name[:-4]}.jpg")
                rows = np.loadtxt(f"{base}/inference/detected_labels/{name}", ndmin=2)
                require(rows.shape[1] == 6 and (np.diff(rows[:, 5]) >= 0).all(), name)
                require(np.array_equal(rows.astype(np.float32), entry[side.lower()]), name)
                require(entry[side.lower()].dtype == np.float32)
            left = "-".join(parts[:-1] + ["Left", parts[-1][:-4] + ".jpg"])
            distance = distances.loc[left, "distance"]
            require(entry["dist"].dtype == np.float32 and entry["dist"].shape == ())
            require(abs(distance - entry["dist"]) < 1e-5 * distance, left)
            frames += 1
    return frames


if __name__ == "__main__":
    print(globals()[sys.argv[1]](sys.argv[2]))
