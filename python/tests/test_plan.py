"""Long calls: plans, simulations, verification, trials; progress and Ctrl-C."""

import copy
import json
import os
import pathlib
import pickle
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest

import numpy as np

import stillbase
from support import problem


class Planning(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.problem = problem("planar_two_link_c2_a", search={"starts": 32})
        cls.steps = []
        cls.plan = stillbase.plan(cls.problem, progress=lambda *step: cls.steps.append(step))

    def test_plan_is_that_of_the_problem(self):
        plan = self.plan
        self.assertEqual(plan.status, "optimal")
        self.assertEqual(plan.problem.to_json(), self.problem.to_json())
        self.assertLess(plan.objective["nominal"], 1e-9)
        self.assertEqual(plan.impact.case, "C2")
        best = plan.candidates[0]
        self.assertLessEqual(best.worst_case, plan.candidates[-1].worst_case)
        self.assertEqual(best.excluded, f"at the contact: {best.collision}")
        self.assertEqual(best.turns, {})
        np.testing.assert_allclose(
            self.problem.impact_at(plan.configuration).Delta_Omega, plan.impact.Delta_Omega
        )

    def test_progress_is_told(self):
        self.assertGreater(len(self.steps), 10)
        what, done, total = self.steps[-1]
        self.assertIsInstance(what, str)
        self.assertTrue(all(0 <= done <= total for _, done, total in self.steps))

    def test_approach_ends_at_the_configuration(self):
        approach = self.plan.approach
        self.assertEqual(approach.status, "found")
        k, n = approach.times.size, self.problem.robot.n
        for rows, columns in (
            (approach.joint_positions, n),
            (approach.joint_velocities, n),
            (approach.joint_torques, n),
            (approach.base_positions, 3),
            (approach.base_orientations, 4),
            (approach.base_velocities, 6),
        ):
            self.assertEqual(rows.shape, (k, columns))
        self.assertFalse(approach.joint_positions.flags.owndata)
        np.testing.assert_allclose(
            approach.joint_positions[-1], self.plan.configuration.joint_positions, atol=1e-9
        )
        np.testing.assert_allclose(np.linalg.norm(approach.base_orientations, axis=1), 1)

    def test_file_dict_and_object_say_the_same(self):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "plan.json"
            self.plan.save(path)
            with self.assertRaises(stillbase.FileError):
                self.plan.save(path)
            loaded = stillbase.Plan.load(path)
            self.assertEqual(loaded.to_json(), self.plan.to_json())
            data = self.plan.to_dict()
            self.assertEqual(data["content_sha256"], json.loads(path.read_text())["content_sha256"])
            np.testing.assert_array_equal(
                data["approach"]["joint_positions"], self.plan.approach.joint_positions
            )
            text = path.read_text().replace('"status": "optimal"', '"status": "feasible"', 1)
            path.write_text(text)
            with self.assertRaises(stillbase.InputError) as caught:
                stillbase.Plan.load(path)
            self.assertEqual(caught.exception.rule, "fingerprint")
            self.assertEqual(stillbase.Plan.load(path, check_fingerprint=False).status, "feasible")

    def test_copies_by_pickle_are_equal(self):
        other = pickle.loads(pickle.dumps(self.plan))
        self.assertEqual(other.to_json(), self.plan.to_json())
        self.assertEqual(other.problem.to_json(), self.plan.problem.to_json())
        self.assertTrue(stillbase.verify(other).passes)

    def test_copies_by_pickle_keep_the_functions_of_the_user(self):
        with self.assertWarns(RuntimeWarning):
            bent = problem("planar_three_link_client", search={"starts": 4}).with_term("bend", bend)
        plan = stillbase.plan(bent, max_approaches=1)
        for other in (plan, pickle.loads(pickle.dumps(plan)), copy.deepcopy(plan)):
            with self.assertRaisesRegex(stillbase.InputError, "functions of the user"):
                stillbase.Replanner(other)

    def test_verification_passes_a_plan_and_fails_an_altered_one(self):
        verdict = stillbase.verify(self.plan)
        self.assertTrue(verdict.passes)
        self.assertEqual(verdict.to_dict()["verdict"], "pass")
        self.assertIn("audit", {check.group for check in verdict.checks})
        data = json.loads(self.plan.to_json())
        data["impact"]["impulse"]["force"][0] *= 1.001
        altered = stillbase.Plan.from_json(json.dumps(data))
        verdict = stillbase.verify(altered, audit=False)
        self.assertFalse(verdict.passes)
        failed = [check for check in verdict.checks if check.passes is False]
        self.assertIn("physics", {check.group for check in failed})

    def test_simulation_conserves_the_momentum(self):
        run = stillbase.simulate(self.plan, "joint_damping")
        self.assertEqual((run.controller, run.status), ("joint_damping", "finished"))
        self.assertEqual(run.joint_positions.shape, (run.times.size, 2))
        scale = np.linalg.norm(self.plan.impact.impulse)
        np.testing.assert_allclose(run.momentum_total_N - run.momentum_total_N[0], 0, atol=1e-9 * scale)
        np.testing.assert_allclose(
            run.momentum_base + run.momentum_coupling, run.momentum_total, atol=1e-9 * scale
        )
        np.testing.assert_array_equal(run.base_orientations[0], self.plan.configuration.base_orientation)
        self.assertEqual(run.to_dict()["runs"][0]["status"], "finished")
        self.assertEqual(len(run.to_csv().splitlines()), run.times.size + 1)
        with self.assertRaisesRegex(ValueError, "rns_damped"):
            stillbase.simulate(self.plan, "hope")

    def test_a_problem_is_simulated_at_any_configuration(self):
        at = self.plan.configuration
        by_plan = stillbase.simulate(self.plan)
        by_problem = stillbase.simulate(self.problem, configuration=at)
        np.testing.assert_allclose(by_problem.joint_positions, by_plan.joint_positions, atol=1e-9)
        with self.assertRaisesRegex(ValueError, "has 3 joint positions"):
            stillbase.simulate(self.problem, configuration=stillbase.Configuration(np.zeros(3)))

    def test_trials_do_not_depend_on_workers(self):
        one = stillbase.trials(self.plan, 24, seed=3)
        told = []
        two = stillbase.trials(self.plan, 24, seed=3, jobs=2, progress=lambda *s: told.append(s))
        self.assertEqual(one.inputs.tobytes(), two.inputs.tobytes())
        self.assertEqual(one.residual_base_rate.tobytes(), two.residual_base_rate.tobytes())
        self.assertEqual(one.inputs.shape, (24, len(one.input_names)))
        self.assertEqual(one.success.dtype, bool)
        self.assertEqual(one.success_probability, one.success.mean())
        self.assertEqual(told[-1][1:], (24, 24))
        self.assertEqual(one.to_dict()["count"], 24)
        sizes = one.to_dict()["perturbations"]
        self.assertEqual(sizes["joint_position"], [])
        single = {key: 0.0 for key, value in sizes.items() if isinstance(value, float | int)}
        exact = stillbase.trials(self.plan, 4, sizes=single)
        np.testing.assert_allclose(exact.impulse, np.linalg.norm(self.plan.impact.impulse[:3]))
        many = stillbase.trials(self.plan, 24, seed=3, jobs=2**28, time_limit=30)
        self.assertEqual(one.inputs.tobytes(), many.inputs.tobytes())
        with self.assertRaisesRegex(ValueError, "'luck' is not known"):
            stillbase.trials(self.plan, 4, sizes={"luck": 1.0})


class Stopping(unittest.TestCase):
    """A problem whose search takes minutes with these starts."""

    def setUp(self):
        self.problem = problem("iiwa_client_50", search={"starts": 200000})

    def test_other_threads_run_meanwhile_and_the_time_limit_holds(self):
        counted, running = 0, True

        def count():
            nonlocal counted
            while running:
                counted += 1
                time.sleep(0.001)

        thread = threading.Thread(target=count)
        thread.start()
        plan = stillbase.plan(self.problem, time_limit=0.5)
        running = False
        thread.join()
        self.assertEqual(plan.status, "limit")
        self.assertGreater(counted, 10)
        with self.assertRaisesRegex(ValueError, "time_limit"):
            stillbase.plan(self.problem, time_limit=float("nan"))

    def test_ctrl_c_gives_the_best_so_far(self):
        timer = threading.Timer(0.4, os.kill, (os.getpid(), signal.SIGINT))
        timer.start()
        with self.assertRaises(stillbase.Interrupted) as caught:
            stillbase.plan(self.problem, time_limit=60)
        self.assertIsInstance(caught.exception, KeyboardInterrupt)
        self.assertEqual(caught.exception.result.status, "limit")

    def test_daemon_threads_end_with_the_interpreter(self):
        """In a long call, in batches, while progress is told, and in a function that takes longer
        than is waited for, while the interpreter is ending."""
        slow_end = "Late.kept = Late()"
        for work, before in (
            ("stillbase.plan(problem, time_limit=60)", ""),
            ("stillbase.plan(problem, time_limit=60, progress=lambda *step: None)", ""),
            ("problem.robot.respond(postures, impulse)", ""),
            ("stillbase.plan(problem, jobs=1, progress=lambda *step: sleep(2.6))", slow_end),
        ):
            with self.subTest(work):
                script = f"""
import threading, time
import numpy as np
import stillbase
class Late:
    def __del__(self, sleep=time.sleep):
        sleep(1.5)
{before}
sleep = time.sleep
problem = stillbase.Problem.from_file(stillbase.PROBLEMS / "iiwa_client_50.yaml")
problem = problem.replace(search={{"starts": 200000}})
postures, impulse = np.zeros((20000, problem.robot.n)), np.ones(6)
begun = threading.Event()
def work():
    while True:
        begun.set()
        {work}
threading.Thread(target=work, daemon=True).start()
begun.wait()
time.sleep(0.3)
"""
                ended = subprocess.run(
                    [sys.executable, "-c", script], capture_output=True, text=True, timeout=30
                )
                self.assertEqual((ended.returncode, ended.stderr), (0, ""))

    def test_an_ending_interpreter_interrupts_a_plan(self):
        """Which would take minutes; what cannot be interrupted is waited for for 2 s."""
        script = """
import threading, time
import stillbase
problem = stillbase.Problem.from_file(stillbase.PROBLEMS / "iiwa_client_50.yaml")
problem = problem.replace(search={"starts": 200000})
threading.Thread(target=stillbase.plan, args=(problem,), daemon=True).start()
time.sleep(0.3)
print(time.time())
"""
        ended = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True)
        self.assertLess(time.time() - float(ended.stdout), 1.5)

    def test_functions_called_at_exit_plan_to_the_end(self):
        script = """
import atexit
def late():
    print(stillbase.plan(problem).status)
atexit.register(late)
import stillbase
problem = stillbase.Problem.from_file(stillbase.PROBLEMS / "planar_two_link_c2_a.yaml")
"""
        ended = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True)
        self.assertEqual((ended.stdout, ended.stderr), ("optimal\n", ""))

    def test_what_progress_raises_ends_the_search(self):
        def fail(what, done, total):
            raise LookupError(what)

        with self.assertRaises(LookupError):
            stillbase.plan(self.problem, progress=fail, time_limit=60)


def bend(configuration, impact):
    """Smooth function of the posture alone."""
    return float(configuration.joint_positions @ configuration.joint_positions)


if __name__ == "__main__":
    unittest.main()
