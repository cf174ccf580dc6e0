"""Plans the pre-impact configuration of a free-floating space robot.

    import stillbase

    problem = stillbase.Problem.from_file(stillbase.PROBLEMS / "iiwa_client_50.yaml")
    plan = stillbase.plan(problem)
    print(plan.status, plan.objective["value"], plan.objective["unit"])
    assert stillbase.verify(plan).passes

SI units and radians everywhere. The base frame B has its origin at the centroid of the base body;
six-vectors have the linear part first: base velocity [v; omega], impulse [f; t] at the hand.
N is the inertial frame. Quaternions are [w, x, y, z].

What a file, dict or keyword states wrongly is an InputError with file, line, rule and text. A
search that finds nothing is a status of its plan. Objects do not change (but for a Replanner), so
any number of threads may use them at once. `stillbase.PROBLEMS` is the folder of the shipped problem files.
"""

import pathlib

from ._errors import FileError, Finding, InputError, Interrupted
from ._program import NonlinearProgram
from ._stillbase import (
    Approach,
    Candidate,
    Check,
    Configuration,
    Evaluation,
    Impact,
    Jump,
    NullSpace,
    ObjectiveValues,
    Plan,
    Posture,
    Problem,
    ReplanUpdate,
    Replanner,
    Response,
    Responses,
    Robot,
    Simulation,
    Trials,
    Verification,
    __version__,
    impact,
    plan,
    simulate,
    trials,
    verify,
)

#: Folder of the shipped problem files, with their robots and targets.
PROBLEMS = pathlib.Path(__file__).parent / "problems"

__all__ = [
    "Approach",
    "Candidate",
    "Check",
    "Configuration",
    "Evaluation",
    "FileError",
    "Finding",
    "Impact",
    "InputError",
    "Interrupted",
    "Jump",
    "NonlinearProgram",
    "NullSpace",
    "ObjectiveValues",
    "PROBLEMS",
    "Plan",
    "Posture",
    "Problem",
    "ReplanUpdate",
    "Replanner",
    "Response",
    "Responses",
    "Robot",
    "Simulation",
    "Trials",
    "Verification",
    "__version__",
    "impact",
    "plan",
    "simulate",
    "trials",
    "verify",
]
