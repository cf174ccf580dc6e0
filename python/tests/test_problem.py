"""Problems from files, dicts and keywords go through one reader."""

import collections
import copy
import dataclasses
import json
import math
import pathlib
import pickle
import tempfile
import types
import unittest
import unittest.mock
import warnings

import numpy as np

import stillbase
from support import PROBLEMS, problem


def sections():
    """A small problem as a dict of sections."""
    return {
        "purpose": "An impulse on the paper's two-link arm.",
        "robot": {
            "file": "robots/planar_two_link_a.urdf",
            "hand": "hand",
            "start": {"joint_1": "-80 deg", "joint_2": "160 deg"},
        },
        "impact": {
            "source": "given",
            "direction": [1.0, 0.0, 0.0],
            "frame": "base",
            "magnitude": 10,
        },
        "objective": "base_angular_momentum",
    }


def changed(section, key, value):
    """The small problem with another value in one of its sections; section '' is the top."""
    out = sections()
    (out if section == "" else out[section])[key] = value
    return out


class Reading(unittest.TestCase):
    def refusal(self, stated):
        with self.assertRaises(stillbase.InputError) as caught:
            stillbase.Problem.from_dict(stated, folder=str(PROBLEMS))
        return caught.exception

    def test_every_shipped_problem_reads_back_from_its_dict(self):
        files = sorted(PROBLEMS.glob("*.yaml"))
        self.assertGreater(len(files), 20)
        for path in files:
            with self.subTest(path.name):
                read = stillbase.Problem.from_file(path)
                again = stillbase.Problem.from_dict(
                    read.to_dict(), urdf=read.robot.urdf, source=str(path)
                )
                self.assertEqual(again.to_json(), read.to_json())

    def test_keywords_dataclasses_and_namespaces_are_dicts(self):
        @dataclasses.dataclass
        class ImpactSection:
            source: str = "given"
            direction: tuple = (1, 0, 0)
            frame: str = "base"
            magnitude: float = 10.0

        expected = stillbase.Problem.from_dict(sections(), folder=str(PROBLEMS)).to_json()
        stated = sections()
        stated["robot"] = types.SimpleNamespace(
            file=pathlib.Path("robots/planar_two_link_a.urdf"),
            hand="hand",
            start=np.radians([-80, 160]),
        )
        stated["impact"] = ImpactSection()
        self.assertEqual(stillbase.Problem(folder=str(PROBLEMS), **stated).to_json(), expected)

    def test_every_kind_of_fault_is_refused_by_its_rule_and_key(self):
        looped = []
        looped.append(looped)
        for section, key, value, rule in (
            ("impact", "magnitud", 1, "unknown-key"),
            ("impact", "magnitude", "ten", "wrong-type"),
            ("impact", "magnitude", "10", "wrong-type"),  # text, as in quotes
            ("impact", "magnitude", True, "wrong-type"),
            ("impact", "magnitude", "10 deg", "wrong-unit"),
            ("impact", "magnitude", -1, "out-of-range"),
            ("impact", "magnitude", math.nan, "not-finite"),
            ("impact", "magnitude", np.float32("inf"), "not-finite"),
            ("impact", "direction", [1, 0], "wrong-length"),
            ("impact", "direction", looped, "too-deep"),
            ("impact", "magnitude", object(), "wrong-type"),
            ("robot", "hand", "hnd", "hand-unknown"),
            ("", "format", "stillbase.plan", "format"),
        ):
            with self.subTest(key=key, value=str(value)[:20]):
                error = self.refusal(changed(section, key, value))
                self.assertIn(rule, [finding.rule for finding in error.findings])
                self.assertIn(key, str(error))
        for value in (np.clongdouble(1), np.array(np.clongdouble(1)), unittest.mock.MagicMock()):
            with self.subTest(value=str(value)[:20]):
                error = self.refusal(changed("impact", "magnitude", value))
                self.assertIn("wrong-type", [finding.rule for finding in error.findings])
        error = self.refusal(changed("impact", 3, 1))
        self.assertIn("impact: the key 3 must be text", str(error))
        self.assertEqual(error.line, 0)

    def test_numbers_of_every_floating_type_are_numbers(self):
        def read(value):
            return stillbase.Problem.from_dict(
                changed("impact", "magnitude", value), folder=str(PROBLEMS)
            ).to_dict()["impact"]["magnitude"]

        for kind in (np.float16, np.float32, np.float64, np.longdouble):
            with self.subTest(kind.__name__):
                self.assertEqual(read(kind(8.5)), 8.5)
                self.assertEqual(read(np.array(kind(8.5))), 8.5)
        long = changed("impact", "direction", np.array([1, 0, 0], np.longdouble))
        self.assertEqual(
            stillbase.Problem.from_dict(long, folder=str(PROBLEMS)).to_json(),
            stillbase.Problem.from_dict(sections(), folder=str(PROBLEMS)).to_json(),
        )
        after = problem().replace(search={"starts": np.longdouble(8)})
        self.assertEqual(after.to_dict()["search"]["starts"], 8)
        with self.assertRaisesRegex(stillbase.InputError, "not-finite"):
            read(np.finfo(np.longdouble).max)  # beyond the numbers of a file

    def test_findings_are_those_of_a_file(self):
        stated = changed("impact", "magnitud", 1)
        stated["impact"]["direction"] = [1, 0]
        stated["search"] = {"starts": 0}
        del stated["objective"]
        by_dict = self.refusal(stated)
        stated.update(format="stillbase.problem", version=1)
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "problem.yaml"
            stated["robot"]["file"] = str(PROBLEMS / stated["robot"]["file"])
            path.write_text(json.dumps(stated))
            with self.assertRaises(stillbase.InputError) as caught:
                stillbase.Problem.from_file(path)
        by_file = caught.exception
        self.assertEqual(
            sorted((f.rule, f.message) for f in by_dict.findings),
            sorted((f.rule, f.message) for f in by_file.findings),
        )
        self.assertGreaterEqual(len(by_file.findings), 4)
        self.assertEqual(by_file.file, str(path))
        self.assertEqual(by_file.line, 1)

    def test_a_missing_file_is_said(self):
        with self.assertRaises((stillbase.InputError, stillbase.FileError)) as caught:
            stillbase.Problem.from_file("missing.yaml")
        self.assertIn("missing.yaml", str(caught.exception))


class Changing(unittest.TestCase):
    def test_replace_keeps_everything_else(self):
        before = problem()
        after = before.replace(search={"starts": 8})
        expected = before.to_dict()
        expected["search"]["starts"] = 8
        self.assertEqual(repr(after.to_dict()), repr(expected))
        self.assertNotEqual(before.to_json(), after.to_json())
        with self.assertRaisesRegex(stillbase.InputError, "did you mean 'starts'"):
            before.replace(search={"stars": 8})

    def test_replace_takes_namespaces_dataclasses_and_mappings_as_dicts(self):
        @dataclasses.dataclass
        class Search:
            seed: int = 3

        before = problem(search={"starts": 8})
        expected = before.replace(search={"seed": 3}).to_json()
        for section in (
            types.SimpleNamespace(seed=3),
            Search(),
            collections.UserDict(seed=3),
            types.MappingProxyType({"seed": 3}),
        ):
            with self.subTest(type(section).__name__):
                self.assertEqual(before.replace(search=section).to_json(), expected)

    def test_copies_and_pickles_are_equal(self):
        before = problem().with_term("bend", bend, gradient=bend_gradient)
        for other in (copy.deepcopy(before), pickle.loads(pickle.dumps(before))):
            self.assertEqual(other.to_json(), before.to_json())
            x = np.full(2, 0.3)
            self.assertEqual(
                stillbase.NonlinearProgram(other).objective(x),
                stillbase.NonlinearProgram(before).objective(x),
            )

    def test_a_function_without_gradient_is_differentiated_with_a_warning(self):
        with self.assertWarnsRegex(RuntimeWarning, "'bend' has no gradient"):
            by_differences = problem().with_term("bend", bend, size=0.5)
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            by_gradient = problem().with_term("bend", bend, size=0.5, gradient=bend_gradient)
        x = np.array([0.4, -0.7])
        a = stillbase.NonlinearProgram(by_differences).evaluate(x)
        b = stillbase.NonlinearProgram(by_gradient).evaluate(x)
        self.assertAlmostEqual(a.objective, b.objective)
        np.testing.assert_allclose(a.gradient, b.gradient, rtol=1e-7)

    def test_a_constraint_of_the_user_is_a_row(self):
        with_row = problem().with_constraint("bend", bend, upper=1.0, gradient=bend_gradient)
        without = stillbase.NonlinearProgram(problem())
        program = stillbase.NonlinearProgram(with_row)
        x = np.array([0.4, -0.7])
        self.assertEqual(program.get_nic(), without.get_nic() + 1)
        rows = program.evaluate(x).constraints
        self.assertAlmostEqual(rows[-1], bend(program.configuration(x), None))

    def test_exceptions_of_user_functions_come_through(self):
        def fail(configuration, impact):
            raise LookupError("of the user")

        broken = problem().with_term("broken", fail, gradient=bend_gradient)
        with self.assertRaisesRegex(LookupError, "of the user"):
            stillbase.plan(broken)
        wrong = problem().with_term("bend", bend, gradient=lambda c, i: np.zeros(5))
        with self.assertRaisesRegex(ValueError, "has 5 components, the search has 2 variables"):
            stillbase.NonlinearProgram(wrong).evaluate(np.zeros(2))

    def test_user_functions_must_return_numbers(self):
        for value in (None, "1", np.zeros(3)):
            with self.subTest(repr(value)):
                broken = problem().with_term("broken", lambda c, i: value, gradient=bend_gradient)
                with self.assertRaisesRegex(TypeError, "broken: must return a number"):
                    stillbase.NonlinearProgram(broken).evaluate(np.zeros(2))
                with self.assertRaisesRegex(TypeError, "broken: must return a number"):
                    stillbase.plan(broken)

    def test_user_gradients_must_be_vectors(self):
        broken = problem().with_term("bend", bend, gradient=lambda c, i: np.zeros((3, 3)))
        with self.assertRaisesRegex(ValueError, "bend: the gradient has 2 dimensions"):
            stillbase.NonlinearProgram(broken).evaluate(np.zeros(2))


def bend(configuration, impact):
    """Smooth function of the posture alone."""
    return float(configuration.joint_positions @ configuration.joint_positions)


def bend_gradient(configuration, impact):
    """Its gradient over the two joints."""
    return 2 * configuration.joint_positions


if __name__ == "__main__":
    unittest.main()
