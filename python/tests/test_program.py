"""The nonlinear program for other optimizers."""

import copy
import pickle
import unittest

import numpy as np

import stillbase
from support import problem

try:
    import scipy.optimize
except ImportError:
    scipy = None
try:
    import pygmo
except ImportError:
    pygmo = None


class Program(unittest.TestCase):
    def setUp(self):
        self.program = stillbase.NonlinearProgram(problem("iiwa_client_50"))
        lower, upper = self.program.get_bounds()
        self.x = lower + (upper - lower) * np.random.default_rng(3).uniform(0.2, 0.8, lower.size)

    def test_gradient_is_that_of_differences(self):
        h = 1e-6
        columns = []
        for k in range(self.x.size):
            step = h * np.eye(self.x.size)[k]
            columns.append((self.program.fitness(self.x + step) - self.program.fitness(self.x - step)) / (2 * h))
        expected = np.stack(columns, axis=1)
        gradient = self.program.gradient(self.x).reshape(expected.shape)
        np.testing.assert_allclose(gradient, expected, rtol=1e-5, atol=1e-6)
        self.assertEqual(
            self.program.fitness(self.x).size,
            1 + self.program.get_nec() + self.program.get_nic(),
        )

    def test_rows_are_the_constraints_with_their_bounds(self):
        g = self.program.evaluate(self.x).constraints
        lower, upper = self.program.constraint_lower, self.program.constraint_upper
        is_kept = np.all((lower - 1e-9 <= g) & (g <= upper + 1e-9))
        rows = self.program.fitness(self.x)[1:]
        equations = self.program.get_nec()
        rows_are_kept = np.all(np.abs(rows[:equations]) <= 1e-9) and np.all(rows[equations:] <= 1e-9)
        self.assertEqual(is_kept, rows_are_kept)
        violation = np.maximum(0, np.maximum(lower - g, g - upper))
        worst = max(np.abs(rows[:equations]).max(initial=0), rows[equations:].max(initial=0))
        self.assertAlmostEqual(violation.max(), worst)
        for part in self.program.constraints:
            sign = -1 if part["type"] == "ineq" else 1
            self.assertEqual(part["jac"](self.x).shape, (part["fun"](self.x).size, self.x.size))
            self.assertLessEqual((sign * part["fun"](self.x)).max(), worst + 1e-12)

    def test_variables_and_configuration_are_inverse(self):
        configuration = self.program.configuration(self.x)
        np.testing.assert_allclose(self.program.variables(configuration), self.x, atol=1e-12)
        self.assertAlmostEqual(
            self.program.value(self.x),
            np.linalg.norm(self.program.problem.impact_at(configuration).base),
        )

    def test_copies_have_the_same_fitness(self):
        for other in (copy.deepcopy(self.program), pickle.loads(pickle.dumps(self.program))):
            np.testing.assert_array_equal(other.fitness(self.x), self.program.fitness(self.x))

    def test_points_outside_the_shape_are_refused(self):
        with self.assertRaisesRegex(ValueError, "^x: "):
            self.program.fitness(np.zeros(3))
        with self.assertRaisesRegex(ValueError, "not finite"):
            self.program.fitness(np.full(self.x.size, np.nan))
        with self.assertRaisesRegex(ValueError, r"must be in \[0, 1\)"):
            self.program.start_point(np.full(self.x.size, 1.0))
        for _ in range(2):  # the second time beside a remembered point of the same numbers
            with self.assertRaisesRegex(ValueError, "^x: has the shape"):
                self.program.evaluate(self.x[np.newaxis])
            self.program.evaluate(self.x)

    def test_configurations_of_other_robots_are_refused(self):
        for size in (0, 6, 8):
            other = stillbase.Configuration(np.zeros(size))
            with self.assertRaisesRegex(ValueError, f"has {size} joint positions, the robot has 7"):
                self.program.variables(other)


@unittest.skipIf(scipy is None, "skipped: python3-scipy is not installed")
class Scipy(unittest.TestCase):
    def test_slsqp_finds_what_the_planner_finds(self):
        capture = problem("planar_three_link_null")
        program = stillbase.NonlinearProgram(capture)
        best = np.inf
        for u in np.random.default_rng(5).uniform(size=(8, program.lower.size)):
            found = scipy.optimize.minimize(
                program.objective,
                program.start_point(u),
                jac=program.objective_gradient,
                bounds=program.bounds,
                constraints=program.constraints,
                method="SLSQP",
                options={"ftol": 1e-14, "maxiter": 200},
            )
            if found.success and program.fitness(found.x)[1:].max(initial=0) < 1e-6:
                best = min(best, program.value(found.x))
        plan = stillbase.plan(capture.replace(search={"starts": 16}))
        self.assertLess(best, plan.objective["nominal"] + 1e-3)


@unittest.skipIf(pygmo is None, "pygmo is not installed: Debian has none")
class Pygmo(unittest.TestCase):
    def test_it_is_a_problem(self):
        program = stillbase.NonlinearProgram(problem("planar_three_link_null"))
        population = pygmo.population(pygmo.problem(program), 4, seed=1)
        algorithm = pygmo.algorithm(pygmo.nlopt("slsqp"))
        self.assertLess(algorithm.evolve(population).champion_f[0], population.champion_f[0] + 1e-9)


if __name__ == "__main__":
    unittest.main()
