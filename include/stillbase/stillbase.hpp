// The calls that most programs need, on one page. Everything is in namespace stillbase; the headers
// below have the details, and src/README.md says where all else is.
//
//   from files
//     read_robot(path, hand)                        robot from a URDF file
//     read_problem(path)                            capture problem with its robot and target
//     load_plan(path), write_plan(plan, path)       plan files
//   one posture, all in the base frame B
//     compute_kinematics(robot, phi)                poses of all bodies
//     compute_inertia(robot, kinematics)            H_b, H_bphi, H_phi: equation (1)
//     compute_tilde_inertia, compute_hat_inertia    base translation, or the whole base, eliminated
//     compute_hand_jacobian(robot, kinematics)      J_phi, R_bh: equation (3)
//     angular_reaction_null_space(tilde)            equation (9)
//   one impact
//     summarize_impact(robot, phi, resistance, Fbar, 0)   for a given impulse on the hand
//     impact_at(problem, configuration)                   by the contact law of a problem
//     start_configuration(problem)                        its stated posture and base pose
//   a capture
//     make_plan(problem)                            search, approach path, certificate
//     simulate_post_impact(problem, configuration, impact, controller)   the time afterwards
//     Replanner(plan).replan(estimate)              posture and time for a new estimate
//     verify_plan(plan)                             does it work, by other code
//     judge_plan(plan)                              the same, and is its search record right
//
// Shapes and frames: phi is n joint positions (rad, m for prismatic joints); six-vectors have the
// linear part first; Fbar is [force; moment] on the hand in B (N s, N m s); B has its origin at the
// centroid of the base body.
//
// Errors: what a file states wrongly is an InputError with file, line, key and rule; what the
// system refuses is a FileError. A search that finds nothing is a status in the plan, never an
// exception. Data are plain structs without hidden state: any number of threads may use the same
// robot or problem at once.
//
// Link with stillbase::stillbase. For plans with proofs link stillbase::proof as well and call
// enable_proofs() of <stillbase/proof/proof.hpp> first. examples/ has six programs that begin here.
#pragma once

#include <stillbase/audit/audit.hpp>                   // judge_plan
#include <stillbase/core/error.hpp>                    // InputError, FileError
#include <stillbase/dynamics/inertia.hpp>              // compute_inertia
#include <stillbase/dynamics/jacobian.hpp>             // compute_hand_jacobian
#include <stillbase/dynamics/kinematics.hpp>           // compute_kinematics
#include <stillbase/dynamics/reaction_null_space.hpp>  // angular_reaction_null_space
#include <stillbase/encounter/encounter.hpp>           // impact_at, start_configuration
#include <stillbase/impact/summary.hpp>                // summarize_impact
#include <stillbase/io/plan_file.hpp>                  // load_plan, write_plan
#include <stillbase/io/problem_file.hpp>               // read_problem
#include <stillbase/planner/planner.hpp>               // make_plan
#include <stillbase/planner/post_impact.hpp>           // simulate_post_impact
#include <stillbase/planner/replanner.hpp>             // Replanner
#include <stillbase/robot/urdf_reader.hpp>             // read_robot
#include <stillbase/verification/verification.hpp>     // verify_plan
