"""Robots, postures and impacts against numpy's own algebra."""

import concurrent.futures
import gc
import unittest

import numpy as np

import stillbase
from support import PROBLEMS, robot

RANDOM = np.random.default_rng(7)
IMPULSE = np.array([0.3, -1.0, 0.5, 0.02, 0.1, -0.05])  # N s, N m s


class Posture(unittest.TestCase):
    def setUp(self):
        self.robot = robot()
        self.phi = RANDOM.uniform(-1.5, 1.5, self.robot.n)
        self.posture = self.robot.evaluate(self.phi)

    def test_jump_solves_the_equation_of_motion(self):
        p = self.posture
        inertia = np.block([[p.H_b, p.H_bphi], [p.H_bphi.T, p.H_phi]])
        jacobian = np.hstack((p.R_bh, p.J_phi))
        expected = np.linalg.solve(inertia, jacobian.T @ IMPULSE)
        jump = self.robot.jump(self.phi, IMPULSE)
        np.testing.assert_allclose(jump.Delta_Omega, expected[:6], rtol=1e-10, atol=1e-13)
        np.testing.assert_allclose(jump.Delta_phidot, expected[6:], rtol=1e-10, atol=1e-13)
        np.testing.assert_allclose(p.B @ IMPULSE, expected[3:6], rtol=1e-10, atol=1e-13)
        np.testing.assert_allclose(
            p.hand_inverse_inertia, jacobian @ np.linalg.solve(inertia, jacobian.T), rtol=1e-9
        )

    def test_eliminated_inertias_are_schur_complements(self):
        p = self.posture
        hat = p.H_phi - p.H_bphi.T @ np.linalg.solve(p.H_b, p.H_bphi)
        np.testing.assert_allclose(p.Hhat_phi, hat, rtol=1e-10, atol=1e-12)
        v, w = slice(0, 3), slice(3, 6)
        mass = p.H_b[v, v]
        tilde = p.H_b[w, w] - p.H_b[v, w].T @ np.linalg.solve(mass, p.H_b[v, w])
        np.testing.assert_allclose(p.Htilde_omega, tilde, rtol=1e-10)

    def test_momentum_is_shared_by_base_and_arm(self):
        response = self.posture.respond(IMPULSE)
        lever = self.posture.hand_position - self.posture.centroid
        total = np.cross(lever, IMPULSE[:3]) + IMPULSE[3:]
        np.testing.assert_allclose(response.total, total, rtol=1e-12)
        np.testing.assert_allclose(response.base + response.coupling, total, rtol=1e-10)
        np.testing.assert_allclose(
            response.coupling, self.posture.Htilde_omegaphi @ response.Delta_phidot, rtol=1e-9
        )

    def test_gradient_is_that_of_differences(self):
        weights = {
            "velocity": RANDOM.normal(size=3),
            "omega": RANDOM.normal(size=3),
            "base": RANDOM.normal(size=3),
            "total": RANDOM.normal(size=3),
            "hand_inverse_mass": 0.7,
            "momentum": RANDOM.normal(size=6),
            "phidot": RANDOM.normal(size=self.robot.n),
        }

        def psi(phi, impulse):
            posture = self.robot.evaluate(phi)
            r = posture.respond(impulse)
            return (
                weights["velocity"] @ r.Delta_Omega[:3]
                + weights["omega"] @ r.Delta_Omega[3:]
                + weights["base"] @ r.base
                + weights["total"] @ r.total
                + weights["hand_inverse_mass"] * r.hand_inverse_mass
                + weights["momentum"] @ posture.H_b @ r.Delta_Omega
                + weights["phidot"] @ r.Delta_phidot
            )

        by_phi, by_impulse = self.posture.gradient(IMPULSE, **weights)
        h = 1e-6
        for k in range(self.robot.n):
            step = h * np.eye(self.robot.n)[k]
            slope = (psi(self.phi + step, IMPULSE) - psi(self.phi - step, IMPULSE)) / (2 * h)
            self.assertAlmostEqual(by_phi[k], slope, delta=1e-6 * (1 + abs(slope)))
        for k in range(6):
            step = h * np.eye(6)[k]
            slope = (psi(self.phi, IMPULSE + step) - psi(self.phi, IMPULSE - step)) / (2 * h)
            self.assertAlmostEqual(by_impulse[k], slope, delta=1e-6 * (1 + abs(slope)))

    def test_null_space_leaves_the_base_still(self):
        for kind, coupling in (
            ("angular", self.posture.Htilde_omegaphi),
            ("full", self.posture.H_bphi),
        ):
            space = self.posture.null_space(kind)
            self.assertEqual(space.rank, np.linalg.matrix_rank(coupling))
            scale = space.singular_values[0]
            np.testing.assert_allclose(coupling @ space.projector / scale, 0, atol=1e-12)
            np.testing.assert_allclose(
                coupling @ space.pseudoinverse @ coupling, coupling, atol=1e-10 * scale
            )
            rns, orthogonal = space.split(self.phi)
            np.testing.assert_allclose(rns + orthogonal, self.phi, rtol=1e-12)
            np.testing.assert_allclose(coupling @ rns / scale, 0, atol=1e-12)
        planar = robot("planar_two_link_a")
        self.assertEqual(planar.evaluate([0.3, 0.4]).null_space().rank, 1)
        with self.assertRaisesRegex(ValueError, "angular, full, translational"):
            self.posture.null_space("linear")

    def test_arrays_are_views_that_keep_their_object(self):
        view = self.posture.H_b
        expected = view.copy()
        self.assertFalse(view.flags.owndata)
        self.assertFalse(view.flags.writeable)
        del self.posture
        gc.collect()
        self.robot.evaluate(self.phi + 1)  # would take the memory if it were free
        np.testing.assert_array_equal(view, expected)

    def test_dict_has_what_inspect_prints(self):
        data = self.posture.to_dict()
        np.testing.assert_array_equal(data["H_b"], self.posture.H_b)
        self.assertEqual(data["joint_names"], self.robot.joint_names)

    def test_numbers_that_do_not_fit_are_refused_by_name(self):
        for phi in (np.zeros(6), np.zeros((7, 1)), np.full(7, np.nan), np.full(7, np.inf)):
            with self.assertRaisesRegex(ValueError, "^phi: "):
                self.robot.jump(phi, IMPULSE)
        with self.assertRaisesRegex(ValueError, r"^impulse: has the shape \(5,\), must have \(6,\)"):
            self.robot.jump(self.phi, np.zeros(5))
        with self.assertRaisesRegex(ValueError, "^locked: has 2 flags"):
            self.robot.jump(self.phi, IMPULSE, locked=[True, False])
        with self.assertRaisesRegex(ValueError, "added_inertia: must not be negative"):
            self.robot.jump(self.phi, IMPULSE, added_inertia=np.full(7, -1.0))

    def test_numbers_whose_answer_no_double_holds_are_refused(self):
        huge, large = np.full(6, 1e308), np.full(6, 1e200)
        phi = np.linspace(-1, 1, self.robot.n)  # whether 1e308 is too much depends on the posture
        posture = self.robot.evaluate(phi)
        calls = {
            "jump": lambda: self.robot.jump(phi, huge),
            "jump with added inertia": lambda: self.robot.jump(
                phi, huge, added_inertia=np.full(self.robot.n, 1e-3)
            ),
            "impact": lambda: stillbase.impact(self.robot, phi, huge),
            "response": lambda: posture.respond(huge),
            "response of the second power": lambda: posture.respond(large),
            "gradient": lambda: posture.gradient(huge, omega=np.full(3, 1e10)),
            "batch": lambda: self.robot.respond(phi[None], huge),
            "batch of the second power": lambda: self.robot.respond(phi[None], large),
            "batch with a target": lambda: self.robot.respond(
                phi[None], 1e-3 * IMPULSE, approach=[1e308], target_inverse_mass=[1e-6]
            ),
            "objective": lambda: self.robot.objective(
                phi[None], huge, {"base_angular_momentum": 1.0}
            ),
        }
        for name, call in calls.items():
            with self.subTest(name), self.assertRaisesRegex(ValueError, "so large that"):
                call()

    def test_resistance_is_that_of_the_problem_file(self):
        inertia = np.linspace(1, 2, self.robot.n)
        stated = {"model": "rotor_inertia", "rotor_inertia": inertia}
        impact = stillbase.impact(self.robot, self.phi, IMPULSE, joint_resistance=stated)
        jump = self.robot.jump(self.phi, IMPULSE, added_inertia=inertia)
        np.testing.assert_allclose(impact.Delta_Omega, jump.Delta_Omega, rtol=1e-12)
        locked = self.robot.jump(self.phi, IMPULSE, locked=[True] * self.robot.n)
        np.testing.assert_array_equal(locked.Delta_phidot, 0)
        with self.assertRaisesRegex(stillbase.InputError, "joint_resistance.model"):
            stillbase.impact(self.robot, self.phi, IMPULSE, joint_resistance={"model": "stiff"})


class ManyPostures(unittest.TestCase):
    def setUp(self):
        self.robot = robot()
        self.phi = RANDOM.uniform(-1.5, 1.5, (37, self.robot.n))
        self.impulses = RANDOM.normal(size=(37, 6))

    def test_rows_are_those_of_single_postures(self):
        many = self.robot.respond(self.phi, self.impulses)
        for i, (phi, impulse) in enumerate(zip(self.phi, self.impulses)):
            one = self.robot.evaluate(phi).respond(impulse)
            np.testing.assert_allclose(many.Delta_Omega[i], one.Delta_Omega, rtol=1e-9, atol=1e-12)
            np.testing.assert_allclose(many.base[i], one.base, rtol=1e-9, atol=1e-12)
            np.testing.assert_allclose(many.total[i], one.total, rtol=1e-9, atol=1e-12)
            self.assertAlmostEqual(many.hand_inverse_mass[i], one.hand_inverse_mass)
        np.testing.assert_array_equal(many.p, 1)
        same = self.robot.respond(self.phi, self.impulses[0])
        np.testing.assert_array_equal(same.Delta_Omega[0], many.Delta_Omega[0])

    def test_contact_law_gives_the_size_of_the_impulse(self):
        approach, inverse_mass = np.full(37, 0.06), np.full(37, 0.02)
        many = self.robot.respond(
            self.phi, self.impulses, approach=approach, target_inverse_mass=inverse_mass
        )
        np.testing.assert_allclose(many.p, approach / (many.hand_inverse_mass + inverse_mass))
        with self.assertRaisesRegex(ValueError, "state both of them"):
            self.robot.respond(self.phi, self.impulses, approach=approach)
        with self.assertRaisesRegex(ValueError, "target_inverse_mass: must be at least 0"):
            self.robot.respond(
                self.phi, self.impulses, approach=approach, target_inverse_mass=-inverse_mass
            )

    def test_objective_and_gradient_agree_with_responses(self):
        values = self.robot.objective(
            self.phi, self.impulses, {"base_angular_momentum": 1.0, "base_rate": 4.0}
        )
        many = self.robot.respond(self.phi, self.impulses)
        expected = 0.5 * (many.base**2).sum(axis=1) + 2 * (many.Delta_Omega[:, 3:] ** 2).sum(axis=1)
        np.testing.assert_allclose(values.value, expected, rtol=1e-9)
        h = 1e-6
        for k in range(self.robot.n):
            step = h * np.eye(self.robot.n)[k]
            weights = {"base_angular_momentum": 1.0, "base_rate": 4.0}
            above = self.robot.objective(self.phi + step, self.impulses, weights)
            below = self.robot.objective(self.phi - step, self.impulses, weights)
            slope = (above.value - below.value) / (2 * h)
            np.testing.assert_allclose(values.gradient[:, k], slope, rtol=1e-5, atol=1e-6)
        with self.assertRaisesRegex(ValueError, "'spin' is not known; there are base_velocity"):
            self.robot.objective(self.phi, self.impulses, {"spin": 1.0})

    def test_any_layout_of_the_array_is_taken(self):
        expected = self.robot.respond(self.phi, IMPULSE).Delta_Omega
        for phi in (np.asfortranarray(self.phi), self.phi[::-1][::-1], self.phi.tolist()):
            np.testing.assert_array_equal(self.robot.respond(phi, IMPULSE).Delta_Omega, expected)
        self.assertEqual(self.robot.respond(np.empty((0, 7)), IMPULSE).Delta_Omega.shape, (0, 6))

    def test_threads_give_the_same_bytes(self):
        def evaluate(_):
            many = self.robot.respond(self.phi, self.impulses)
            one = self.robot.jump(self.phi[0], IMPULSE)
            return many.Delta_Omega.tobytes() + one.Delta_phidot.tobytes()

        with concurrent.futures.ThreadPoolExecutor(4) as pool:
            self.assertEqual(len(set(pool.map(evaluate, range(200)))), 1)


class FromElsewhere(unittest.TestCase):
    def test_text_and_section_give_the_same_robot(self):
        from_file = robot()
        self.assertEqual(
            stillbase.Robot.from_urdf(from_file.urdf, "hand").joint_names, from_file.joint_names
        )
        section = {"file": "robots/iiwa_on_cube.urdf", "hand": "hand", "start": [0.4] * 7}
        from_dict = stillbase.Robot.from_dict(section, folder=str(PROBLEMS))
        np.testing.assert_array_equal(from_dict.upper, from_file.upper)
        self.assertEqual(from_dict.total_mass, from_file.total_mass)

    def test_what_is_wrong_is_said_with_file_line_and_rule(self):
        text = robot().urdf.replace('<mass value="', '<mass value="-', 1)
        with self.assertRaises(stillbase.InputError) as caught:
            stillbase.Robot.from_urdf(text, "hand", "arm.urdf")
        error = caught.exception
        self.assertEqual(error.file, "arm.urdf")
        self.assertGreater(error.line, 0)
        self.assertIn(f"arm.urdf:{error.line}: {error.rule}: ", str(error))
        self.assertIsInstance(error, ValueError)
        with self.assertRaises(stillbase.InputError) as caught:
            stillbase.Robot.from_dict({"file": "robots/iiwa_on_cube.urdf", "hnd": "hand"}, PROBLEMS)
        self.assertIn("did you mean 'hand'", str(caught.exception))


if __name__ == "__main__":
    unittest.main()
