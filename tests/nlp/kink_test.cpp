// Minima at kinks of a constraint: min(g_1, ..., g_k) >= 0 as one row, against g_1 >= 0, ... as k.
#include <catch2/catch.hpp>

#include <stillbase/core/random.hpp>
#include <stillbase/nlp/optimizer.hpp>

#include "nlp/kink_cuts.hpp"

namespace stillbase::nlp {
namespace {

/// The point nearest to a wanted one where sets with curved faces meet.
class NearestInBodies : public Problem {
 public:
  NearestInBodies(Eigen::MatrixXd normals, Eigen::VectorXd wanted, bool as_one_row)
      : normals_(std::move(normals)), wanted_(std::move(wanted)), as_one_row_(as_one_row) {}

  int num_variables() const override { return static_cast<int>(wanted_.size()); }
  int num_constraints() const override {
    return as_one_row_ ? 1 : static_cast<int>(normals_.rows());
  }
  Eigen::VectorXd lower() const override {
    return Eigen::VectorXd::Constant(wanted_.size(), -kInfinity);
  }
  Eigen::VectorXd upper() const override { return -lower(); }
  Eigen::VectorXd constraint_lower() const override {
    return Eigen::VectorXd::Zero(num_constraints());
  }
  Eigen::VectorXd constraint_upper() const override {
    return Eigen::VectorXd::Constant(num_constraints(), kInfinity);
  }
  bool may_have_kinks(int) const override { return as_one_row_; }
  void evaluate(const Eigen::VectorXd& x, Evaluation& out) const override {
    ++evaluations;
    constexpr double kCurvature = 0.1;
    out.objective = (x - wanted_).squaredNorm() / 2;
    out.gradient = x - wanted_;
    out.constraints = (1 - kCurvature * x.squaredNorm() / 2 - (normals_ * x).array()).matrix();
    out.jacobian = -(normals_.rowwise() + kCurvature * x.transpose());
    if (!as_one_row_) return;
    Eigen::Index least = 0;
    const double value = out.constraints.minCoeff(&least);
    out.constraints = Eigen::VectorXd::Constant(1, value);
    out.jacobian = Eigen::MatrixXd(out.jacobian.row(least));
  }

  mutable int evaluations = 0;

 private:
  Eigen::MatrixXd normals_;
  Eigen::VectorXd wanted_;
  bool as_one_row_;
};

}  // namespace

TEST_CASE("sqp finds minima at kinks and says that it did") {
  Random random(3);
  int at_kinks = 0, evaluations = 0;
  for (int trial = 0; trial < 60; ++trial) {
    CAPTURE(trial);
    Eigen::MatrixXd normals(6, 4);
    for (double& entry : normals.reshaped()) entry = random.uniform(-1, 1);
    normals.rowwise().normalize();
    Eigen::VectorXd wanted(4);
    for (double& entry : wanted) entry = random.uniform(-4, 4);
    const NearestInBodies bodies(normals, wanted, false), least(normals, wanted, true);
    const Eigen::VectorXd start = Eigen::VectorXd::Zero(4);
    const auto sqp = make_optimizer("sqp");
    const OptimizeResult apart = sqp->minimize(bodies, start);
    REQUIRE(apart.status == Status::Optimal);
    CHECK_FALSE(apart.at_kink);
    const OptimizeResult together = sqp->minimize(least, start);
    CHECK(together.feasible);
    CHECK((together.x - apart.x).norm() < 1e-5);
    const bool has_kink = (apart.constraints.array() < 1e-7).count() > 1;
    CHECK(together.at_kink == has_kink);
    if (!has_kink) continue;
    CHECK(together.certificate.kkt_residual > 1e-3);
    ++at_kinks;
    evaluations += together.evaluations;
  }
  CAPTURE(at_kinks, evaluations);
  CHECK(at_kinks > 20);
  CHECK(evaluations < 40 * at_kinks);
}

TEST_CASE("cuts are kept near a kink and forgotten where they say nothing") {
  // |x_1| as the least row -|x_1| + 1 >= 0: normals (-1, 0) and (1, 0).
  const std::vector<Side> sides = {{0, 1, -1, false, true}};
  const auto at = [](double x) {
    SqpPoint out;
    out.x = Eigen::Vector2d(x, 0);
    out.at.constraints = Eigen::VectorXd::Constant(1, -std::abs(x));
    out.at.jacobian = Eigen::RowVector2d(x > 0 ? -1 : 1, 0);
    return out;
  };
  const Eigen::VectorXd active = Eigen::VectorXd::Ones(1);
  KinkCuts cuts(sides);
  CHECK_FALSE(cuts.take(0, at(0.1), at(0.2)));  // the same side
  REQUIRE(cuts.take(0, at(1e-3), at(-1e-3)));
  REQUIRE(cuts.all().size() == 1);
  // The other part, 1 + x, is 1 + 1e-3 here, the least is 1 - 1e-3.
  CHECK(std::abs(cuts.room_at(at(1e-3), cuts.all().front()) - (1 + 1e-3)) < 1e-15);
  // A cut from the same part is no lower than the row itself.
  CHECK(cuts.room_at(at(-2e-3), cuts.all().front()) == 1 - 2e-3);

  REQUIRE(cuts.limiting().size() == 1);
  cuts.count(0, 0);
  CHECK(cuts.limiting().empty());
  cuts.count(0, 1);

  cuts.follow(at(1e-3), at(-2e-3), active);  // across: the cut is now the row, and the other way
  CHECK(cuts.is_kinked(0));
  REQUIRE(cuts.all().size() == 1);
  CHECK(cuts.all().front().normal[0] == -1);
  cuts.follow(at(-2e-3), at(-1), active);  // too far away
  CHECK_FALSE(cuts.is_kinked(0));
  CHECK(cuts.all().empty());

  // Between the iterate and the cut the normal jumps at a kink, and turns all along for curvature.
  REQUIRE(cuts.take(0, at(1e-9), at(-0.1)));
  SqpPoint looked;
  CHECK(cuts.is_kink(0, at(1e-9), [&](const Eigen::VectorXd& x) { return &(looked = at(x[0])); }));
  CHECK_FALSE(cuts.is_kink(0, at(1e-9), [&](const Eigen::VectorXd& x) {
    looked = at(x[0]);
    looked.at.jacobian(0, 0) = -1 - 20 * x[0];
    return &looked;
  }));
  CHECK_FALSE(cuts.is_kink(0, at(1e-9), [](const auto&) { return nullptr; }));
  cuts.forget(0);
  CHECK(cuts.all().empty());
}

}  // namespace stillbase::nlp
