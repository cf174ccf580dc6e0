"""Plans that follow an estimate of their target."""

import csv
import math
import threading
import unittest

import numpy as np

import stillbase
from support import problem

STREAM = stillbase.PROBLEMS / "streams" / "iiwa_client_50.csv"


def estimates():
    with open(STREAM, encoding="utf-8") as lines:
        rows = csv.DictReader(line for line in lines if not line.startswith("#"))
        for row in rows:
            value = {name: float(cell) for name, cell in row.items()}
            yield {
                "time": value["time_s"],
                "position": [value[f"{a}_m"] for a in "xyz"],
                "orientation": [value[f"q{a}"] for a in "wxyz"],
                "linear_velocity": [value[f"v{a}_m_s"] for a in "xyz"],
                "angular_velocity": [value[f"w{a}_rad_s"] for a in "xyz"],
                "covariance": np.diag([v * v for n, v in value.items() if n.startswith("sd_")]),
            }


class Replanning(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        asked = problem("iiwa_client_50", search={"starts": 8}, approach={"enabled": False})
        cls.plan = stillbase.plan(asked)
        cls.stream = list(estimates())

    def test_first_posture_is_that_of_the_plan(self):
        last = stillbase.Replanner(self.plan).last
        self.assertEqual(last.status, "optimal")
        np.testing.assert_allclose(
            last.configuration.joint_positions, self.plan.configuration.joint_positions, atol=1e-5
        )
        self.assertAlmostEqual(last.value, self.plan.objective["value"], places=9)

    def test_updates_are_feasible_and_no_worse_than_the_corrected_posture(self):
        replanner = stillbase.Replanner(self.plan)
        for estimate in self.stream[::15]:
            update = replanner.replan(**estimate)
            self.assertIn(update.status, ("optimal", "feasible"))
            self.assertLessEqual(update.max_violation, 1e-9)
            self.assertLessEqual(update.value, update.corrected_value * (1 + 1e-12))
            margins = [c["margin"] for c in update.constraints]
            self.assertGreater(min(margins), -1e-9)
            self.assertGreater(update.contact["point"], 0)
            self.assertTrue(69 <= update.configuration.contact_time <= 75)
        self.assertEqual(replanner.last.value, update.value)
        self.assertIn("ReplanUpdate", repr(update))

    def test_a_deadline_that_has_passed_is_said(self):
        replanner = stillbase.Replanner(self.plan)
        update = replanner.replan(**self.stream[0], deadline=0)
        self.assertTrue(update.was_cut)
        self.assertEqual(update.kkt_residual, math.inf)
        self.assertIsNone(update.contact)
        self.assertFalse(replanner.replan(**self.stream[0]).was_cut)

    def test_wrong_input_is_refused(self):
        replanner = stillbase.Replanner(self.plan)
        late = dict(self.stream[0], time=80)
        self.assertEqual(replanner.replan(**late).status, "refused")
        self.assertIn("no time", replanner.last.reason)
        with self.assertRaises(ValueError):
            replanner.replan(**dict(self.stream[0], position=[0, 0]))
        good = self.stream[0]["covariance"]
        for wrong, words in (
            (np.diag(good), r"\(12,\), must have \(12, 12\)"),
            (good[:11], r"\(11, 12\), must have \(12, 12\)"),
            (good * math.nan, "is not finite"),
            (-good, "a variance is not negative"),
            (np.triu(np.full((12, 12), 1e-6)), "a covariance is symmetric"),
            (np.full((12, 12), 1e-6) - 1e-7 * np.eye(12), "not positive semidefinite"),
            (np.diag([*np.full(11, 1.0), -1e-12]), r"\[11\]\[11\]: is -1e-12"),
        ):
            with self.assertRaisesRegex(ValueError, "^.*covariance.*" + words):
                replanner.replan(**dict(self.stream[0], covariance=wrong))
        for right in (0 * good, good, np.full((12, 12), 1e-9), None):
            status = replanner.replan(**dict(self.stream[0], covariance=right)).status
            self.assertEqual(status, "optimal")
        with self.assertRaises(ValueError):
            replanner.replan(**self.stream[0], deadline=-1)
        with self.assertRaises(ValueError):
            stillbase.Replanner(self.plan, max_steps=0)
        stated = stillbase.plan(problem("planar_two_link_c2_a", search={"starts": 8}))
        with self.assertRaises(stillbase.InputError) as caught:
            stillbase.Replanner(stated)
        self.assertEqual(caught.exception.rule, "not-replannable")

    def test_replanners_of_one_plan_are_independent(self):
        values = {}

        def play(name):
            replanner = stillbase.Replanner(self.plan)
            values[name] = [replanner.replan(**e).value for e in self.stream[:30]]

        threads = [threading.Thread(target=play, args=(name,)) for name in "ab"]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(values["a"], values["b"])


if __name__ == "__main__":
    unittest.main()
