"""Every public name has a docstring and a stub, and the stub says what the module takes."""

import ast
import importlib.util
import inspect
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

import stillbase
from stillbase import _stillbase

STUB = pathlib.Path(stillbase.__file__).resolve().parent / "_stillbase.pyi"
# Of pybind11's own, and for pickling: no part of the interface.
HIDDEN = re.compile(r"_(?!_init__$).*")


def stubs():
    """Name -> parameters of functions and methods, None for properties and classes."""
    out = {}

    def note(node, prefix):
        if isinstance(node, ast.FunctionDef):
            parameters = [a.arg for a in node.args.args + node.args.kwonlyargs]
            is_property = any(getattr(d, "id", "") == "property" for d in node.decorator_list)
            out[prefix + node.name] = None if is_property else [p for p in parameters if p != "self"]
        elif isinstance(node, ast.ClassDef):
            out[prefix + node.name] = None
            for inner in node.body:
                note(inner, node.name + ".")

    for top in ast.parse(STUB.read_text()).body:
        note(top, "")
    return out


def members(owner, prefix=""):
    """(name, object) of everything public in the compiled module."""
    for name in vars(owner):
        if HIDDEN.fullmatch(name):
            continue
        value = getattr(owner, name)
        if name == "__init__" and "Initialize self" in (value.__doc__ or ""):
            continue  # no constructor
        yield prefix + name, value
        if inspect.isclass(value):
            yield from members(value, name + ".")


class Stubs(unittest.TestCase):
    def test_every_name_of_the_module_has_a_stub_with_its_parameters(self):
        known, found = stubs(), dict(members(_stillbase))
        public = {name for name in known if not HIDDEN.fullmatch(name.split(".")[-1])}
        self.assertEqual(public, set(found))
        self.assertGreater(len(found), 150)
        for name, value in found.items():
            if known[name] is None:
                continue
            # pybind11 states the signature in the first line of the docstring.
            signature = (value.__doc__ or "").splitlines()[0]
            stated = re.findall(r"[(,] \*?\*?(\w+)(?=[:,)])|\((\w+):", signature)
            stated = [a or b for a, b in stated if (a or b) not in ("self", "kwargs")]
            with self.subTest(name):
                self.assertEqual(known[name], stated, signature)

    def test_every_public_name_has_a_docstring(self):
        missing = [name for name in stillbase.__all__ if name != "__version__"
                   and not (getattr(stillbase, name).__doc__ or "").strip()]
        for name, value in members(_stillbase):
            # The first line of a function is pybind11's signature.
            text = (value.__doc__ or "").strip()
            words = text.split("\n", 1)[-1] if "->" in text.split("\n", 1)[0] else text
            if not words.strip() or ("->" in text and "\n" not in text):
                missing.append(name)
        for owner in (stillbase.NonlinearProgram, stillbase.InputError):
            missing += [
                f"{owner.__name__}.{name}"
                for name, value in vars(owner).items()
                if not name.startswith("_") and not (getattr(value, "__doc__", "") or "").strip()
            ]
        self.assertEqual(missing, [])

    def test_objects_without_a_constructor_call_are_refused(self):
        classes = [kind for kind in vars(_stillbase).values() if inspect.isclass(kind)]
        self.assertGreater(len(classes), 20)
        for kind in classes:
            with self.subTest(kind.__name__):
                empty = kind.__new__(kind)
                for name, value in vars(kind).items():
                    if isinstance(value, property):
                        # pybind11 itself refuses what takes a shared pointer.
                        refusal = "has not been made|from non-held to held"
                        with self.assertRaisesRegex((TypeError, RuntimeError), refusal):
                            getattr(empty, name)

    def test_everything_is_listed(self):
        self.assertEqual(sorted(stillbase.__all__), stillbase.__all__)
        for name in dir(_stillbase):
            if not name.startswith("_") and name != "Formulation":  # behind NonlinearProgram
                self.assertIn(name, stillbase.__all__)


GOOD = """
import numpy as np
import stillbase

problem = stillbase.Problem.from_file("problem.yaml").replace(search={"starts": 8})
plan: stillbase.Plan = stillbase.plan(problem, progress=print, time_limit=2)
worst: float = max(candidate.worst_case for candidate in plan.candidates)
run = stillbase.simulate(plan, "rns_damped")
print(np.abs(run.momentum_total).max() + worst, stillbase.verify(plan).passes)
"""
WRONG = """
import stillbase

stillbase.plan("problem.yaml")
stillbase.Robot.from_file(3)
stillbase.verify(stillbase.Plan.load("plan.json")).pases
"""


@unittest.skipIf(importlib.util.find_spec("mypy") is None, "skipped: mypy is not installed")
class Typing(unittest.TestCase):
    def mypy(self, text):
        with tempfile.TemporaryDirectory() as folder:
            program = pathlib.Path(folder) / "program.py"
            program.write_text(text)
            package = pathlib.Path(stillbase.__file__).resolve().parent
            done = subprocess.run(
                [sys.executable, "-m", "mypy", "--strict", "--cache-dir", folder, package, program],
                capture_output=True,
                text=True,
                check=False,
            )
        return done.returncode, done.stdout

    def test_mypy_accepts_the_package_and_a_program(self):
        code, text = self.mypy(GOOD)
        self.assertEqual(code, 0, text)

    def test_mypy_refuses_wrong_types(self):
        code, text = self.mypy(WRONG)
        self.assertEqual(code, 1, text)
        self.assertEqual(text.count("program.py:"), 3, text)


if __name__ == "__main__":
    unittest.main()
