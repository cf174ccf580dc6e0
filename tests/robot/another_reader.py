#!/usr/bin/env python3
"""Reads robot files a second time and compares what the tool says of them.

Usage: another_reader.py TOOL ROBOT.urdf...

Inertia matrices H_b, H_bphi and H_phi, the system's centroid and the hand, at random postures, by
H = sum over links of m Jv'Jv + Jw'I Jw with every link by itself: nothing is merged, no frame is
moved to a centroid. Written with Python's own XML reader and nothing of the library; numbers have
to agree to 1e-12 of the largest of their kind.
"""

import json
import math
import random
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as ElementTree

TOLERANCE = 1e-12
POSTURES = 3


def mul(a, b):
    return [[sum(x * y for x, y in zip(row, column)) for column in zip(*b)] for row in a]


def apply(a, v):
    return [sum(x * y for x, y in zip(row, v)) for row in a]


def add(a, b):
    return [x + y for x, y in zip(a, b)]


def scaled(s, v):
    return [s * x for x in v]


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def turn(axis, angle):
    """Rodrigues' formula."""
    x, y, z = axis
    c, s = math.cos(angle), math.sin(angle)
    d = 1 - c
    return [[c + x * x * d, x * y * d - z * s, x * z * d + y * s],
            [y * x * d + z * s, c + y * y * d, y * z * d - x * s],
            [z * x * d - y * s, z * y * d + x * s, c + z * z * d]]


def numbers(element, key, otherwise):
    text = None if element is None else element.get(key)
    return [float(x) for x in text.split()] if text is not None else otherwise


def pose(element):
    """Rotation and position of an <origin>: fixed axes, x first."""
    origin = element.find("origin")
    roll, pitch, yaw = numbers(origin, "rpy", [0, 0, 0])
    R = mul(turn([0, 0, 1], yaw), mul(turn([0, 1, 0], pitch), turn([1, 0, 0], roll)))
    return R, numbers(origin, "xyz", [0, 0, 0])


class Robot:
    def __init__(self, path):
        root = ElementTree.parse(path).getroot()
        self.links = {link.get("name"): link for link in root.findall("link")}
        self.joints = [j for j in root.findall("joint") if j.find("parent") is not None]
        children = {j.find("child").get("link") for j in self.joints}
        self.root = next(name for name in self.links if name not in children)

    def coordinate(self, joint, q):
        """Position of a joint, and the name and ratio of the coordinate that moves it."""
        name = joint.get("name")
        mimic = joint.find("mimic")
        if mimic is None:
            return q[name], name, 1.0
        ratio = float(mimic.get("multiplier", "1"))
        value, master, inner = self.coordinate(
            next(j for j in self.joints if j.get("name") == mimic.get("joint")), q)
        return ratio * value + float(mimic.get("offset", "0")), master, ratio * inner

    def placed(self, q):
        """Of every link: rotation, position, and the joints before it as (axis, point, coordinate,
        ratio, whether it slides), in the root link's frame."""
        out = {self.root: (turn([1, 0, 0], 0), [0.0, 0.0, 0.0], [])}
        waiting = list(self.joints)
        while waiting:
            joint = next(j for j in waiting if j.find("parent").get("link") in out)
            waiting.remove(joint)
            R, p, path = out[joint.find("parent").get("link")]
            R_origin, p_origin = pose(joint)
            p = add(p, apply(R, p_origin))
            R = mul(R, R_origin)
            if joint.get("type") != "fixed":
                axis = numbers(joint.find("axis"), "xyz", [1, 0, 0])
                axis = scaled(1 / math.sqrt(dot(axis, axis)), axis)
                value, coordinate, ratio = self.coordinate(joint, q)
                slides = joint.get("type") == "prismatic"
                path = path + [(apply(R, axis), p, coordinate, ratio, slides)]
                if slides:
                    p = add(p, scaled(value, apply(R, axis)))
                else:
                    R = mul(R, turn(axis, value))
            out[joint.find("child").get("link")] = R, p, path
        return out

    def inertials(self, placed):
        """Mass, centroid, tensor about it and joints before it, of every link with mass."""
        for name, link in self.links.items():
            inertial = link.find("inertial")
            if inertial is None or float(inertial.find("mass").get("value")) == 0:
                continue
            R, p, path = placed[name]
            R_own, p_own = pose(inertial)
            R_all = mul(R, R_own)
            i = {k: float(v) for k, v in inertial.find("inertia").attrib.items()}
            tensor = [[i["ixx"], i["ixy"], i["ixz"]], [i["ixy"], i["iyy"], i["iyz"]],
                      [i["ixz"], i["iyz"], i["izz"]]]
            tensor = mul(mul(R_all, tensor), [list(column) for column in zip(*R_all)])
            yield (float(inertial.find("mass").get("value")), add(p, apply(R, p_own)), tensor, path)

    def matrices(self, names, q, hand):
        placed = self.placed(q)
        inertials = list(self.inertials(placed))
        base = [(m, c) for m, c, _, path in inertials if not path]
        base_mass = sum(m for m, _ in base)
        origin = [sum(m * c[k] for m, c in base) / base_mass if base_mass > 0 else 0.0
                  for k in range(3)]
        n = len(names)
        H = [[0.0] * (6 + n) for _ in range(6 + n)]
        total, centroid = 0.0, [0.0, 0.0, 0.0]
        for m, c, tensor, path in inertials:
            total += m
            arm = add(c, scaled(-1, origin))
            centroid = add(centroid, scaled(m, arm))
            linear, angular = [], []
            for k in range(3):
                unit = [float(k == i) for i in range(3)]
                linear.append(unit)
                angular.append([0.0, 0.0, 0.0])
            for k in range(3):
                unit = [float(k == i) for i in range(3)]
                linear.append(cross(unit, arm))
                angular.append(unit)
            for name in names:
                v, w = [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]
                for axis, point, coordinate, ratio, slides in path:
                    if coordinate != name:
                        continue
                    axis = scaled(ratio, axis)
                    if slides:
                        v = add(v, axis)
                    else:
                        v = add(v, cross(axis, add(c, scaled(-1, point))))
                        w = add(w, axis)
                linear.append(v)
                angular.append(w)
            for a in range(6 + n):
                for b in range(6 + n):
                    H[a][b] += m * dot(linear[a], linear[b])
                    H[a][b] += dot(angular[a], apply(tensor, angular[b]))
        return {
            "H_b": [row[:6] for row in H[:6]],
            "H_bphi": [row[6:] for row in H[:6]],
            "H_phi": [row[6:] for row in H[6:]],
            "centroid": [scaled(1 / total, centroid)],
            "hand_position": [add(placed[hand][1], scaled(-1, origin))],
        }


def inspect(tool, path, hand, q):
    with tempfile.NamedTemporaryFile("w", suffix=".json") as state:
        json.dump({"joint_positions": q}, state)
        state.flush()
        command = [tool, "inspect", path, "--hand", hand, "--json", "--state", state.name]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        sys.exit(f"{path}: {done.stderr}")
    return json.loads(done.stdout)


def difference(path, tool, posture):
    """Largest difference of a kind over the largest number of that kind."""
    robot = Robot(path)
    parents = {j.find("parent").get("link") for j in robot.joints}
    hand = [name for name in robot.links if name not in parents][-1]
    names = [j.get("name") for j in robot.joints
             if j.get("type") != "fixed" and j.find("mimic") is None]
    if not names:
        return None
    rng = random.Random(f"{path} {posture}")
    q = {}
    for joint in robot.joints:
        if joint.get("name") in names:
            limit = joint.find("limit") if joint.get("type") != "continuous" else None
            q[joint.get("name")] = rng.uniform(numbers(limit, "lower", [-3])[0],
                                               numbers(limit, "upper", [3])[0])
    said = inspect(tool, path, hand, q)
    own = robot.matrices(said["joint_names"], q, hand)
    worst = 0.0
    for kind, rows in own.items():
        theirs = said[kind] if isinstance(said[kind][0], list) else [said[kind]]
        if len(rows) != len(theirs) or len(rows[0]) != len(theirs[0]):
            sys.exit(f"{path}: {kind} has another size")
        size = max(abs(x) for row in rows for x in row) or 1.0
        apart = max(abs(x - y) for a, b in zip(rows, theirs) for x, y in zip(a, b))
        worst = max(worst, apart / size)
    return worst


def main():
    tool, robots = sys.argv[1], sys.argv[2:]
    bad = 0
    for path in robots:
        found = [difference(path, tool, posture) for posture in range(POSTURES)]
        if found[0] is None:
            print(f"{path}: no joints")
            continue
        print(f"{path}: {max(found):.1e}")
        bad += not max(found) <= TOLERANCE
    if bad or not robots:
        sys.exit(f"{bad} of {len(robots)} robots differ by more than {TOLERANCE}")


if __name__ == "__main__":
    main()
