// Rows that are zero, or combinations of others, at all sampled points.
#include <algorithm>

#include <stillbase/core/random.hpp>

#include "formulation/presolve/presolve.hpp"

namespace stillbase {

namespace {

/// Distance from the lower bound and gradient of a row at all samples, one after the other.
struct RowProfile {
  const Constraint* row;
  bool is_violated = false;  ///< somewhere
  Eigen::VectorXd values;    ///< samples x (1 + N)
  double largest_gradient = 0;
};

std::vector<RowProfile> sample_rows(const CaptureModel& model, const ConstraintSet& constraints,
                                    const PresolveOptions& options) {
  const int size = model.layout.size;
  const Eigen::Index width = size + 1;
  std::vector<RowProfile> out;
  for (const auto& row : constraints.rows) {
    out.push_back({row.get(), false, Eigen::VectorXd::Zero(options.samples * width), 0});
  }
  Eigen::RowVectorXd gradient(size);
  for (int sample = 0; sample < options.samples; ++sample) {
    const Eigen::VectorXd u = low_discrepancy_point(sample, size, 0);
    const NominalPoint here(model, model.layout.start_point(model.problem, u));
    for (RowProfile& profile : out) {
      const Constraint& row = *profile.row;
      const double value =
          row.value_and_gradient({model, here.at, here.posture, here.impact}, gradient);
      profile.is_violated = profile.is_violated || value < row.lower - options.zero ||
                            value > row.upper + options.zero;
      profile.largest_gradient = std::max(profile.largest_gradient, gradient.cwiseAbs().maxCoeff());
      auto part = profile.values.segment(sample * width, width);
      part[0] = value - row.lower;
      part.tail(size) = gradient.transpose();
    }
  }
  return out;
}

}  // namespace

int SelectedRows::num_equations() const {
  return static_cast<int>(std::count_if(kept.begin(), kept.end(),
                                        [](const Constraint* row) { return row->is_equation(); }));
}

SelectedRows select_independent_rows(const CaptureModel& model, const ConstraintSet& constraints,
                                     const PresolveOptions& options) {
  SelectedRows out;
  for (const auto& row : constraints.implied) {
    out.reported.push_back(row.get());
    out.redundant.push_back({row->name, Redundancy::ByConstruction});
  }
  std::vector<Eigen::VectorXd> basis;  // orthonormal, of the equations kept
  for (const RowProfile& profile : sample_rows(model, constraints, options)) {
    const Constraint& row = *profile.row;
    if (!profile.is_violated && !(profile.largest_gradient > options.zero)) {
      out.redundant.push_back({row.name, Redundancy::ZeroEverywhere});
      if (row.has_kinks || row.is_always_reported) out.reported.push_back(&row);
      continue;
    }
    if (row.is_equation()) {
      Eigen::VectorXd remainder = profile.values.normalized();
      for (int pass = 0; pass < 2; ++pass) {
        for (const Eigen::VectorXd& direction : basis) {
          remainder -= direction.dot(remainder) * direction;
        }
      }
      if (remainder.norm() <= options.combination) {
        out.reported.push_back(&row);
        out.redundant.push_back({row.name, Redundancy::CombinationOfOthers});
        continue;
      }
      basis.push_back(remainder.normalized());
    }
    out.kept.push_back(&row);
  }
  return out;
}

}  // namespace stillbase
