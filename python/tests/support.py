"""What the tests of the module share."""

import pathlib

import stillbase

ROOT = pathlib.Path(__file__).resolve().parents[2]
PROBLEMS = ROOT / "problems"


def robot(name="iiwa_on_cube", hand="hand"):
    return stillbase.Robot.from_file(PROBLEMS / "robots" / f"{name}.urdf", hand)


def problem(name="planar_two_link_c2_a", **changes):
    return stillbase.Problem.from_file(PROBLEMS / f"{name}.yaml").replace(**changes)
