// Families of capture problems for comparing optimizers: one base problem each, varied by seed.
#pragma once

#include <string>
#include <vector>

#include <stillbase/core/random.hpp>
#include <stillbase/plan/problem.hpp>

namespace stillbase {

/// What an optimizer is asked to do with an instance.
enum class BenchmarkGoal {
  Nominal,    ///< least |y| for the nominal direction
  WorstCase,  ///< least of the largest |y| over fixed directions of the cone
  Case,       ///< least norm of the equations of an impact case, wanted zero
};

std::string to_string(BenchmarkGoal goal);

/// What differs between the instances of a family.
enum class Variation {
  ImpulseDirection,  ///< stated direction: any, or any in the plane of a planar problem
  HandPosition,      ///< stated hand point (and axes): those of a random posture, so reachable
  TargetAttitude,    ///< orientation of the target: any, or rotated in the plane
  TargetSpin,        ///< axis of the target's rotation: any, or its sense in the plane
};

struct FamilySpec {
  std::string name;
  CaptureProblem problem;
  std::vector<BenchmarkGoal> goals;
  CaseConstraint impact_case = CaseConstraint::C2;  ///< of BenchmarkGoal::Case
  std::vector<Variation> vary;
  double cone_half_angle = 0;  ///< rad; of BenchmarkGoal::WorstCase
  /// Further free variables than the problem's own; 0: none.
  double free_attitude = 0;      ///< rad that the base may rotate from the stated attitude
  double free_contact_time = 0;  ///< s before and after the middle of the stated time
  int instances = 15;            ///< per goal
};

struct SuiteSpec {
  /// Cost of a gradient in evaluations, measured: see bench/README.md.
  double gradient_cost = 0.8;
  std::string best_known;  ///< path of the file with the best known values; empty: none
  std::vector<FamilySpec> families;
  std::vector<std::string> approaches;  ///< paths of the problems for the approach planners
};

struct BenchmarkInstance {
  std::string name;  ///< family/goal/number
  std::string family;
  BenchmarkGoal goal = BenchmarkGoal::Nominal;
  CaptureProblem problem;
};

/// When an instance counts as one that can be solved.
struct InstanceOptions {
  int encounters = 50;      ///< that are drawn at the most; part of the stream of random numbers
  int starts = 64;          ///< of which one has to satisfy the constraints
  int steps = 40;           ///< of Newton's method from each
  double violation = 1e-9;  ///< of each constraint, in its unit
};

/// Any posture within the joint limits; a joint without limits anywhere in one revolution.
JointVectord random_posture(const RobotModel& robot, Random& random);

/// Instance `number` (from 0) of a family. The random numbers depend on the family's name and the
/// number alone, so that the goals of one number have the same encounter. Encounters without any
/// posture that satisfies the constraints, as far as the starts can tell, are skipped.
/// @throws InputError when a variation has nothing to vary in the problem, or when no encounter is
/// satisfiable
BenchmarkInstance make_instance(const FamilySpec& family, BenchmarkGoal goal, int number,
                                const InstanceOptions& options = {});

}  // namespace stillbase
