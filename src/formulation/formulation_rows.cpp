// Which rows a problem has: the equations of the hand and of the case, reduced to independent ones.
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <Eigen/LU>

#include <stillbase/core/error.hpp>
#include <stillbase/core/random.hpp>

#include "formulation/formulation_parts.hpp"

namespace stillbase {

namespace {

const char* kAxisNames[3] = {"x", "y", "z"};

bool depends_on_hit(const Row& row) {
  switch (row.kind) {
    case RowKind::CaseTotal:
    case RowKind::CaseBase:
    case RowKind::CaseCoupling:
    case RowKind::CouplingColumn:
    case RowKind::ClosingSpeed:
    case RowKind::JointRate:
      return true;
    default:
      return false;
  }
}

}  // namespace

Formulation::Parts::Parts(const CaptureProblem& p)
    : problem(p),
      layout(p),
      resistance(prepare_resistance(p.resistance, p.robot.n())),
      model(stillbase::encounter_model(p)) {
  if (layout.size == 0) {
    throw InputError(
        {Finding{problem.source, 0, "no-variables", "variables: nothing is free to be planned"}});
  }
  prediction = {predicted()};
  add_rows();
  drop_structural_rows();
  set_combinations_aside();
  rows_need_hit = std::any_of(rows.begin(), rows.end(), depends_on_hit);
}

void Formulation::Parts::add_rows() {
  const HandSpec& hand = problem.hand;
  const bool has_point = model.hand_point || model.hand_follows_target();
  if (hand.constraint != HandConstraint::None && has_point &&
      problem.variables.base_position == PositionFreedom::Fixed) {
    for (int i = 0; i < 3; ++i) {
      rows.push_back(
          {RowKind::HandPosition, i, std::string("hand_position_") + kAxisNames[i], 0, 0});
    }
  }
  if (problem.variables.base_position == PositionFreedom::Box && has_point) {
    for (int i = 0; i < 3; ++i) {
      rows.push_back({RowKind::StationBox, i, std::string("base_position_") + kAxisNames[i],
                      problem.variables.base_position_lower[i],
                      problem.variables.base_position_upper[i]});
    }
  }
  if (hand.constraint == HandConstraint::Axis) {
    rows.push_back({RowKind::HandAxis, 0, "hand_axis_1", 0, 0});
    rows.push_back({RowKind::HandAxis, 1, "hand_axis_2", 0, 0});
    rows.push_back({RowKind::HandFacing, 0, "hand_facing", -kInfinity, 0});
  } else if (hand.constraint == HandConstraint::Pose) {
    for (int i = 0; i < 3; ++i) {
      rows.push_back({RowKind::HandPose, i, std::string("hand_rotation_") + kAxisNames[i], 0, 0});
    }
    rows.push_back({RowKind::PoseFacing, 0, "hand_facing", 0, kInfinity});
  }
  add_case_rows();
  add_margin_rows();
  add_clearance_rows();
  if (layout.time >= 0 && model.follows_target()) {
    rows.push_back({RowKind::ClosingSpeed, 0, "closing_speed",
                    problem.constraints.closing_speed_min, kInfinity});
  }
  const double limit = problem.variables.base_attitude_max;
  if (problem.variables.base_attitude == AttitudeFreedom::Cone) {
    rows.push_back({RowKind::AttitudeCone, 0, "base_attitude_cone", std::cos(limit), kInfinity});
  } else if (layout.attitude_size == 3 && limit < 3.14159) {
    rows.push_back({RowKind::AttitudeAngle, 0, "base_attitude_squared", 0, limit * limit});
  }
}

void Formulation::Parts::add_case_rows() {
  const CaseConstraint wanted = problem.constraints.impact_case;
  const bool total =
      wanted == CaseConstraint::C || wanted == CaseConstraint::C1 || wanted == CaseConstraint::C2;
  const bool coupling = wanted == CaseConstraint::G3 || wanted == CaseConstraint::C2;
  if (total) {
    // r_gh x n is normal to n: two independent rows.
    rows.push_back({RowKind::CaseTotal, 0, "case_total_1", 0, 0});
    rows.push_back({RowKind::CaseTotal, 1, "case_total_2", 0, 0});
    if (!model.moment.isZero(0)) rows.push_back({RowKind::CaseTotal, 2, "case_total_3", 0, 0});
  }
  if (wanted == CaseConstraint::G2) {
    for (int i = 0; i < 3; ++i) {
      rows.push_back({RowKind::CaseBase, i, "case_base_" + std::to_string(i + 1), 0, 0});
    }
  }
  if (!coupling) return;
  // The coupling part lies in the range of the coupling matrix, so its rank counts.
  Random random(0);
  int rank = 0;
  std::vector<int> columns;
  for (int sample = 0; sample < 8; ++sample) {
    JointVectord phi(n());
    for (int k = 0; k < n(); ++k) phi[k] = random.uniform(-3, 3);
    const auto posture = evaluate_posture<double>(problem.robot, resistance, phi);
    Matrix3Xd A = posture.tilde.Htilde_omegaphi;
    for (int k = 0; k < n(); ++k) {
      if (posture.factor.locked[static_cast<std::size_t>(k)]) A.col(k).setZero();
    }
    const ReactionNullSpace space = compute_reaction_null_space(A);
    if (space.rank <= rank) continue;
    rank = space.rank;
    columns.clear();
    Matrix3Xd kept(3, 0);
    for (int k = 0; k < n() && static_cast<int>(columns.size()) < rank; ++k) {
      Matrix3Xd trial(3, kept.cols() + 1);
      trial << kept, A.col(k);
      if (compute_reaction_null_space(trial).rank == trial.cols()) {
        kept = trial;
        columns.push_back(k);
      }
    }
  }
  const bool planar_or_full = rank == 3 || rank <= 1;
  if (planar_or_full) {
    for (int i = 0; i < 3; ++i) {
      rows.push_back({RowKind::CaseCoupling, i, "case_coupling_" + std::to_string(i + 1), 0, 0});
    }
  } else {
    for (std::size_t i = 0; i < columns.size(); ++i) {
      rows.push_back({RowKind::CouplingColumn, columns[i],
                      "case_coupling_column_" + std::to_string(columns[i] + 1), 0, 0});
    }
    // Where two columns are nearly parallel they say little: what counts are the components.
    for (int i = 0; i < 3; ++i) {
      implied_rows.push_back(
          {RowKind::CaseCoupling, i, "case_coupling_" + std::to_string(i + 1), 0, 0});
    }
  }
}

void Formulation::Parts::drop_structural_rows() {
  // A planar robot leaves rows that are zero everywhere; optimizers fail on them.
  constexpr double kZero = 1e-12;
  std::vector<bool> alive(rows.size(), false);
  for (int sample = 0; sample < 8; ++sample) {
    const Eigen::VectorXd x = start_point(low_discrepancy_point(sample, start_dimension(), 0));
    const Local<double> local = localise<double>(x);
    const auto at = posture(local);
    const auto response = impact(local, at, predicted());
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const double value = value_of(rows[i], local, at, response);
      const bool violated = value < rows[i].lower - kZero || value > rows[i].upper + kZero;
      const Eigen::VectorXd gradient = compress(local, gradient_of(rows[i], local, at, response));
      if (violated || gradient.cwiseAbs().maxCoeff() > kZero) alive[i] = true;
    }
  }
  std::vector<Row> kept;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (alive[i]) kept.push_back(rows[i]);
  }
  rows = kept;
}

void Formulation::Parts::set_combinations_aside() {
  // A planar robot whose plane is none of the axes' planes: its rows are multiples of each other.
  constexpr double kCombination = 1e-10;  // of a row's size over all samples
  constexpr int kSamples = 8;
  const Eigen::Index each = layout.size + 1;
  std::vector<Eigen::VectorXd> profiles(rows.size(), Eigen::VectorXd::Zero(kSamples * each));
  for (int sample = 0; sample < kSamples; ++sample) {
    const Eigen::VectorXd x = start_point(low_discrepancy_point(sample, start_dimension(), 0));
    const Local<double> local = localise<double>(x);
    const auto at = posture(local);
    const auto response = impact(local, at, predicted());
    for (std::size_t i = 0; i < rows.size(); ++i) {
      auto part = profiles[i].segment(sample * each, each);
      part[0] = value_of(rows[i], local, at, response) - rows[i].lower;
      part.tail(layout.size) = compress(local, gradient_of(rows[i], local, at, response));
    }
  }
  std::vector<Row> kept;
  std::vector<Eigen::VectorXd> basis;  // orthonormal, of the equations kept
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const bool is_equation = rows[i].lower == rows[i].upper;
    Eigen::VectorXd rest = profiles[i].normalized();
    for (int pass = 0; pass < 2 && is_equation; ++pass) {
      for (const Eigen::VectorXd& direction : basis) rest -= direction.dot(rest) * direction;
    }
    if (is_equation && rest.norm() <= kCombination) {
      implied_rows.push_back(rows[i]);
      continue;
    }
    if (is_equation) basis.push_back(rest.normalized());
    kept.push_back(rows[i]);
  }
  rows = kept;
}

}  // namespace stillbase
