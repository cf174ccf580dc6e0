// Plans for the tests of plan files.
#pragma once

#include <string>

#include <stillbase/core/random.hpp>
#include <stillbase/io/problem_file.hpp>
#include <stillbase/plan/plan.hpp>

#include "io/io_support.hpp"

namespace stillbase::io_test {

inline Pose random_pose(Random& random) {
  return {random.unit_vector() * 3,
          rotation_exp(random.unit_vector() * random.uniform(0, 3)).normalized()};
}

inline JointVectord random_joints(Random& random, int n) {
  JointVectord v(n);
  for (double& x : v) x = random.normal();
  return v;
}

/// A plan with a number of its own in every field.
inline Plan random_plan(const std::string& problem = "problems/planar_two_link_c2_a.yaml") {
  Random random(7);
  Plan plan;
  plan.problem = read_problem(source_path(problem));
  const int n = plan.problem.robot.n();
  plan.problem.resistance.model = ResistanceModel::Servo;
  plan.problem.resistance.stiffness = random_joints(random, n).cwiseAbs();
  plan.problem.resistance.damping = random_joints(random, n).cwiseAbs();
  plan.problem.resistance.contact_duration = 0.1;
  plan.status = PlanStatus::Feasible;
  plan.optimizer = "nlopt-slsqp";
  plan.configuration = {random_joints(random, n), random_pose(random), 1.0 / 3};
  ImpactSummary& impact = plan.impact;
  for (Vector6d* v : {&impact.Fbar, &impact.Delta_Omega}) {
    for (double& x : *v) x = random.normal() * 1e-9;
  }
  impact.Delta_phidot = random_joints(random, n);
  impact.Delta_phidot_rns = random_joints(random, n);
  impact.Delta_phidot_orthogonal = random_joints(random, n);
  impact.total = random.unit_vector();
  impact.base = random.unit_vector() * 1e-300;
  impact.coupling = Vector3d(0, -0.0, 1e17);
  impact.judgement = {ImpactCase::C2, 1e-7, 0.1, 0.2, 0.3};
  impact.rank = 1;
  impact.closing_speed = 0.7;
  impact.resistance = plan.problem.resistance;
  plan.objective = {"base_angular_momentum", "N m s",   0.1 + 0.2, 0.5,
                    random.unit_vector(),    0.1 + 0.2, true,      {{"base_angular_momentum", 0.3}},
                    {"term of a user"},      {}};
  plan.nominal_optimum = {{random_joints(random, n), random_pose(random), 0.7}, 1e-17, 0.9, 0.8};
  plan.constraints = {{"closing_speed", 0.7, 0.01, kInfinity, 0},
                      {"case_total_z", 1e-12, 0, 0, 1e-12},
                      {"hand_facing", -1, -kInfinity, 0, 0}};
  plan.certificate = {1e-9, 1e-12, 256, 8, 0.7, true, -0.1 / 3, {}};
  Proof& proof = plan.certificate.proof;
  proof.status = ProofStatus::Undecided;
  proof.statement = "not decided: 2 solutions enclosed";
  proof.solutions = {{random_joints(random, n), random_joints(random, n)},
                     {random_joints(random, n), random_joints(random, n)}};
  proof.candidates = {1, -1};
  proof.undecided = {{random_joints(random, n), random_joints(random, n)}};
  proof.found_by_search = 1;
  proof.boxes = 1234;
  proof.lower_bound = 0;
  proof.gap = 1e-17 / 3;
  plan.candidates = {{plan.configuration, 1, 2, 0, 12, true, "", 1.0 / 7},
                     {plan.configuration, 1.5, 2, 0, 3, false, "link_2 with base"}};
  plan.families = {{2.0 / 3, true, true, 7, {plan.configuration, plan.configuration}},
                   {1.0 / 7, false, false, 1, {}}};
  plan.candidates[1].family = 1;
  plan.candidates[1].is_judged = false;
  plan.candidates[0].excluded = "after the impact: joint_2 reaches its stop";
  plan.choice = {1, 0.1 + 0.2};
  plan.binding = {{"joint_1", true, 1.0 / 3, 1e-9, 0.1 + 0.7, "rad"},
                  {"closing_speed", false, 0.01, 0, 1e-3, "m/s"}};
  plan.after_horizon = AfterHorizon{0.1 / 3, true, 8.2 / 3, "joint_2"};
  plan.managed_momentum = ManagedMomentum{
      Vector3d(0.1, -0.2, 1.0 / 3), Vector3d(1, 2, -0.7), 0.1 + 0.2, 1e-17 / 3, {}, {}, {}};
  plan.managed_momentum->limits = {{CaptureLimit::WheelTorque, "x", 0.2, 0.2, "N m"},
                                   {CaptureLimit::Reach, "hand", 1.0 / 3, 0.7, "m"}};
  plan.managed_momentum->longest_held = HeldLimit{CaptureLimit::WheelTorque, "x", 20.0 / 3};
  Approach& approach = plan.approach;
  approach.status = ApproachStatus::Found;
  approach.detail = "a \"quoted\" detail\nwith <two> lines";
  for (int i = 0; i < 3; ++i) {
    approach.times.push_back(i / 7.0);
    approach.joint_positions.push_back(random_joints(random, n));
    approach.joint_velocities.push_back(random_joints(random, n));
    approach.joint_accelerations.push_back(random_joints(random, n));
    approach.joint_torques.push_back(random_joints(random, n));
    approach.base_poses.push_back(random_pose(random));
    approach.base_velocities.push_back(Vector6d::Constant(random.normal()));
  }
  approach.duration = 2.0 / 7;
  approach.path_length = random.uniform();
  approach.attitude_excursion = random.uniform();
  approach.min_clearance = kInfinity;
  approach.effort_used = random.uniform();
  approach.hand_position_error = 1e-13;
  approach.hand_angle_error = 0.1 + 0.2;
  approach.late_by = 0.7;
  approach.polish = PathPolish::Attitude;
  approach.before_polish = 0.3;
  approach.after_polish = 0.1;
  plan.solver_calls = {{"nlopt-slsqp", 256}, {"rrt_connect", 1}};
  plan.timing = {{"search", 0.25}};
  return plan;
}

}  // namespace stillbase::io_test
