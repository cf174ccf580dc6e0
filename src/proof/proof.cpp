#include <stillbase/proof/proof.hpp>

#include <algorithm>
#include <cmath>

#include <stillbase/core/random.hpp>

#include "proof/case_rows.hpp"
#include "proof/enclose.hpp"

namespace stillbase {

namespace proof {
namespace {

constexpr int kMaxJointsInProof = kMaxJointsOf<Dual<0>>;

std::string counted(int count, const std::string& what) {
  return std::to_string(count) + " " + what + (count == 1 ? "" : "s");
}

Proof not_applicable(const std::string& reason) {
  Proof out;
  out.statement = reason;
  return out;
}

/// All equations, those that may vanish identically included.
std::vector<Row> all_rows(const ZeroProblem& problem) {
  std::vector<Row> rows;
  const auto add_three = [&](RowKind kind) {
    for (int i = 0; i < 3; ++i) rows.push_back({kind, i, Vector3d::Zero(), 1});
  };
  if (problem.has_hand_point) add_three(RowKind::HandPosition);
  const CaseConstraint wanted = problem.impact_case;
  bool total =
      wanted == CaseConstraint::C || wanted == CaseConstraint::C1 || wanted == CaseConstraint::C2;
  const bool coupling = wanted == CaseConstraint::C2 || wanted == CaseConstraint::G3;
  bool base = wanted == CaseConstraint::G2;
  if (problem.zero && wanted != CaseConstraint::C2) {
    if (*problem.zero == ObjectiveQuantity::TotalAngularMomentum) {
      total = true;
    } else {
      base = true;
    }
  }
  if (total) {
    // Without a moment L = r x f is normal to f: two components say it all.
    const Vector3d f = problem.F.head<3>();
    int smallest = 0;
    f.cwiseAbs().minCoeff(&smallest);
    const Vector3d u = f.cross(Vector3d(Vector3d::Unit(smallest))).normalized();
    const Vector3d v = f.cross(u).normalized();
    rows.push_back({RowKind::Total, 0, u, 1});
    rows.push_back({RowKind::Total, 1, v, 1});
    if (!problem.F.tail<3>().isZero(0)) rows.push_back({RowKind::Total, 2, f.normalized(), 1});
  }
  if (base) add_three(RowKind::Base);
  if (coupling) add_three(total ? RowKind::CouplingAtZeroTotal : RowKind::Coupling);
  return rows;
}

template <int N>
class RowSystem final : public System<N> {
 public:
  RowSystem(const ZeroProblem& problem, const std::vector<Row>& rows)
      : problem_(problem), rows_(rows) {}

  void evaluate(const std::array<Dual<N>, N>& x, std::array<Dual<N>, N>& f) const override {
    fill(x, f);
  }
  void evaluate(const std::array<Dual<0>, N>& x, std::array<Dual<0>, N>& f) const override {
    fill(x, f);
  }

 private:
  template <class S>
  void fill(const std::array<S, N>& x, std::array<S, N>& f) const {
    JointVector<S> phi = problem_.start.template cast<S>();
    for (int i = 0; i < N; ++i) phi[problem_.free[static_cast<std::size_t>(i)]] = x[i];
    const std::vector<S> values = evaluate_rows<S>(problem_, rows_, phi);
    std::copy(values.begin(), values.end(), f.begin());
  }

  const ZeroProblem& problem_;
  const std::vector<Row>& rows_;
};

template <int N>
Box<N> domain_of(const ZeroProblem& problem, std::array<bool, N>& periodic) {
  Box<N> box;
  for (int i = 0; i < N; ++i) {
    const auto index = static_cast<std::size_t>(i);
    const Joint& joint = problem.robot.joints[static_cast<std::size_t>(problem.free[index])];
    periodic[i] = joint.type == JointType::Continuous;
    box[i] = periodic[i] ? Interval(-kPi.upper(), kPi.upper())
                         : Interval(problem.lower[index], problem.upper[index]);
  }
  return box;
}

/// Sizes of the rows over evenly spread postures; rows that vanish everywhere are dropped.
template <int N>
std::vector<Row> live_rows(const ZeroProblem& problem, std::vector<Row> rows) {
  constexpr int kSamples = 16;
  constexpr double kZero = 1e-10;  // of the largest row of its kind
  std::array<bool, N> periodic;
  const Box<N> domain = domain_of<N>(problem, periodic);
  std::vector<double> size(rows.size(), 0);
  for (int sample = 0; sample < kSamples; ++sample) {
    const Eigen::VectorXd u = low_discrepancy_point(sample, N, 0);
    JointVector<Dual<N>> phi = problem.start.template cast<Dual<N>>();
    for (int i = 0; i < N; ++i) {
      const double at = domain[i].lower() + u[i] * (domain[i].upper() - domain[i].lower());
      phi[problem.free[static_cast<std::size_t>(i)]] = Dual<N>(Interval(at), i);
    }
    const auto values = evaluate_rows<Dual<N>>(problem, rows, phi);
    for (std::size_t r = 0; r < rows.size(); ++r) {
      size[r] = std::max(size[r], boost::numeric::norm(values[r].v));
      for (const Interval& d : values[r].d) size[r] = std::max(size[r], boost::numeric::norm(d));
    }
  }
  std::vector<Row> live;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    double largest = 0;
    for (std::size_t q = 0; q < rows.size(); ++q) {
      if (rows[q].kind == rows[r].kind) largest = std::max(largest, size[q]);
    }
    if (!(size[r] > kZero * largest)) continue;
    rows[r].scale = std::exp2(std::round(std::log2(size[r])));  // divides without rounding
    live.push_back(rows[r]);
  }
  return live;
}

template <int N>
JointBox joint_box(const ZeroProblem& problem, const Box<N>& box) {
  JointBox out{problem.start, problem.start};
  for (int i = 0; i < N; ++i) {
    const int k = problem.free[static_cast<std::size_t>(i)];
    out.lower[k] = box[i].lower();
    out.upper[k] = box[i].upper();
  }
  return out;
}

template <int N>
Proof enclose(const ZeroProblem& problem, const ProofOptions& options) {
  const std::vector<Row> rows = live_rows<N>(problem, all_rows(problem));
  if (static_cast<int>(rows.size()) != N) {
    return not_applicable("no proof: " + counted(static_cast<int>(rows.size()), "equation") +
                          " for " + counted(N, "free joint") +
                          ", so the solutions are not isolated points");
  }
  std::array<bool, N> periodic;
  const Box<N> domain = domain_of<N>(problem, periodic);
  const Enclosure<N> found = enclose_zeros<N>(
      RowSystem<N>(problem, rows), domain, periodic,
      {.max_boxes = options.max_boxes, .min_width = options.min_width, .stop = options.stop});
  Proof out;
  out.boxes = found.boxes;
  for (const Zero<N>& zero : found.zeros) out.solutions.push_back(joint_box(problem, zero.tight));
  for (const Box<N>& box : found.undecided) out.undecided.push_back(joint_box(problem, box));
  out.status = found.complete() ? ProofStatus::Complete : ProofStatus::Undecided;
  const std::string solutions = counted(static_cast<int>(out.solutions.size()), "solution");
  if (found.complete() && out.solutions.empty()) {
    out.statement = "proven: there is no solution within the joint limits";
  } else if (found.complete()) {
    out.statement = "proven complete: " + solutions + " enclosed";
  } else {
    out.statement = "not decided: " + solutions + " enclosed, " +
                    counted(static_cast<int>(out.undecided.size()), "place") +
                    " where more may be" + (found.limit_reached ? " (stopped at the limit)" : "");
  }
  return out;
}

}  // namespace
}  // namespace proof

Proof enclose_solutions(const ZeroProblem& problem, const ProofOptions& options) {
  using namespace proof;
  const std::size_t moving =
      static_cast<std::size_t>(problem.robot.n()) -
      static_cast<std::size_t>(std::count(problem.locked.begin(), problem.locked.end(), true));
  if (problem.robot.n() > kMaxJointsInProof || moving > kMaxMovingJoints) {
    return not_applicable("no proof: more than " + std::to_string(kMaxMovingJoints) +
                          " joints move during the impact");
  }
  const RoundUpward upward;
  switch (problem.free.size()) {
    case 1:
      return enclose<1>(problem, options);
    case 2:
      return enclose<2>(problem, options);
    case 3:
      return enclose<3>(problem, options);
    default:
      return not_applicable("no proof: it takes one to three free joints, here are " +
                            std::to_string(problem.free.size()));
  }
}

}  // namespace stillbase
