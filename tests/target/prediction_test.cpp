#include <catch2/catch.hpp>

#include <Eigen/Dense>

#include <stillbase/core/random.hpp>
#include <stillbase/target/prediction.hpp>

using namespace stillbase;

namespace {

constexpr double kDegree = 3.14159265358979323846 / 180;

TargetEstimate tumbling_box() {
  TargetEstimate estimate;
  estimate.body.name = "box";
  estimate.body.mass = 224;
  estimate.body.inertia = Vector3d(45, 40, 37).asDiagonal();
  estimate.state.time = 5;
  estimate.state.pose.position = Vector3d(4, -1, 2);
  estimate.state.pose.orientation = rotation_exp({0.3, -0.8, 0.5});
  estimate.state.linear_velocity = Vector3d(-0.05, 0.01, 0.02);
  estimate.state.angular_velocity =
      estimate.state.pose.orientation * (3 * kDegree * Vector3d(2, -1, 1).normalized());
  return estimate;
}

const ContactFeature kEdge{"edge", {0.5, 0.1, 0.55}, {1, 0, 0}};

/// Errors of every kind; `scale` 1 rotates the normal by several degrees within 30 s.
EstimateDeviations deviations(double scale) {
  EstimateDeviations sigma;
  sigma.position = scale * Vector3d(0.02, 0.01, 0.03);
  sigma.orientation = scale * kDegree * Vector3d(1, 2, 0.5);
  sigma.linear_velocity = scale * Vector3d(1e-3, 5e-4, 2e-3);
  sigma.angular_velocity = scale * kDegree * Vector3d(0.05, 0.03, 0.08);
  sigma.mass = 0.05 * scale;
  sigma.moments = scale * Vector3d(0.02, 0.03, 0.01);
  return sigma;
}

/// Errors of all kinds that depend on each other.
EstimateCovariance correlated(double scale) {
  Random random(7);
  Eigen::MatrixXd mix(kNumEstimateErrors, kNumEstimateErrors);
  for (Eigen::Index i = 0; i < mix.size(); ++i) mix(i) = random.uniform(-1, 1);
  const EstimateCovariance diagonal = covariance_of(deviations(scale));
  const Eigen::VectorXd sigma = diagonal.diagonal().cwiseSqrt();
  const Eigen::MatrixXd root = sigma.asDiagonal() * mix / std::sqrt(int{kNumEstimateErrors} / 3.0);
  return root * root.transpose();
}

struct Sampled {
  ContactVector mean = ContactVector::Zero();
  ContactCovariance spread = ContactCovariance::Zero();  ///< second moments about the estimate
  ContactCovariance fourth = ContactCovariance::Zero();  ///< of their products, for errors
  ContactVector variance = ContactVector::Zero();
  std::vector<ContactVector> values;
};

Sampled sample(const TargetEstimate& estimate, const EstimateCovariance& covariance,
               const ContactPrediction& prediction, int count) {
  const Eigen::MatrixXd dense = covariance;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(dense);
  const Eigen::MatrixXd root =
      eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0).cwiseSqrt().asDiagonal();
  Random random(20);
  Sampled sampled;
  for (int i = 0; i < count; ++i) {
    EstimateVector z;
    for (int k = 0; k < kNumEstimateErrors; ++k) z[k] = random.normal();
    const TargetEstimate moved = with_error(estimate, root * z);
    const TargetMotion motion(moved.body, moved.state,
                              std::abs(prediction.time - estimate.state.time) + 1);
    const ContactVector y =
        contact_vector(moved.body, kEdge, motion.contact(kEdge, prediction.time),
                       prediction.estimated, prediction.effective_mass) -
        prediction.value;
    sampled.values.push_back(y);
    const ContactCovariance square = y * y.transpose();
    sampled.mean += y / count;
    sampled.spread += square / count;
    sampled.fourth += square.cwiseAbs2() / count;
  }
  sampled.variance = sampled.spread.diagonal() - sampled.mean.cwiseAbs2();
  return sampled;
}

double normal_angle(const ContactVector& y) { return y.segment<3>(kContactNormal).norm(); }

}  // namespace

TEST_CASE("predicted mean and covariance of a contact are those of samples") {
  const TargetEstimate estimate = tumbling_box();
  constexpr int kCount = 4000;
  for (const EstimateCovariance& covariance : {covariance_of(deviations(0.5)), correlated(0.5)}) {
    const ContactPrediction p = predict_contact(estimate, covariance, kEdge, {35.0}).front();
    const Sampled sampled = sample(estimate, covariance, p, kCount);
    for (int i = 0; i < kNumContactQuantities; ++i) {
      // Five standard errors; the remainder is what a transform of second order leaves out, in
      // parts of the quantity's own standard deviation.
      const double sigma = std::sqrt(p.spread(i, i));
      INFO("quantity " << i << ", sigma " << sigma);
      CHECK(std::abs(p.mean[i] - p.value[i] - sampled.mean[i]) <=
            5 * std::sqrt(sampled.variance[i] / kCount) + 0.005 * sigma);
      for (int j = 0; j <= i; ++j) {
        const double error =
            std::sqrt((sampled.fourth(i, j) - std::pow(sampled.spread(i, j), 2)) / kCount);
        CHECK(std::abs(p.spread(i, j) - sampled.spread(i, j)) <=
              5 * error + 0.01 * sigma * std::sqrt(p.spread(j, j)));
      }
    }
    CHECK(p.closing_speed_deviation() ==
          Approx(std::sqrt(sampled.spread(kClosingSpeed, kClosingSpeed))).epsilon(0.06));
  }
}

TEST_CASE("the cone holds the stated part of the sampled normals") {
  const TargetEstimate estimate = tumbling_box();
  constexpr int kCount = 4000;
  const EstimateCovariance covariance = covariance_of(deviations(1));
  const ContactPrediction p = predict_contact(estimate, covariance, kEdge, {35.0}).front();
  const Sampled sampled = sample(estimate, covariance, p, kCount);
  const Vector3d plane = p.estimated.normal.unitOrthogonal();
  for (const double probability : {0.5, 0.9, 0.95, 0.99}) {
    const double cone = cone_half_angle(p, probability);
    const double wedge = wedge_half_angle(p, plane, probability);
    CHECK(cone > 3 * kDegree * probability);
    int in_cone = 0, in_wedge = 0;
    for (const ContactVector& y : sampled.values) {
      if (normal_angle(y) <= cone) ++in_cone;
      if (std::abs(plane.dot(y.segment<3>(kContactNormal))) <= wedge) ++in_wedge;
    }
    INFO(probability << ": cone " << cone / kDegree << " deg, wedge " << wedge / kDegree);
    // Four standard errors and half a percent for what is not Gaussian.
    const double slack = 4 * std::sqrt(probability * (1 - probability) / kCount) + 0.005;
    CHECK(std::abs(double(in_cone) / kCount - probability) <= slack);
    CHECK(std::abs(double(in_wedge) / kCount - probability) <= slack);
    CHECK(wedge < cone);
  }
}

TEST_CASE("a body that does not rotate has closed-form contact errors") {
  TargetEstimate estimate = tumbling_box();
  estimate.state.angular_velocity.setZero();
  EstimateDeviations sigma;
  sigma.position = Vector3d(0.02, 0.01, 0.03);
  sigma.linear_velocity = Vector3d(1e-3, 5e-4, 2e-3);
  const double dt = 30;
  const ContactPrediction p =
      predict_contact(estimate, covariance_of(sigma), kEdge, {estimate.state.time + dt}).front();
  const Vector3d variance =
      sigma.position.cwiseAbs2() + dt * dt * sigma.linear_velocity.cwiseAbs2();
  CHECK((p.point_deviation().cwiseAbs2() - variance).norm() <= 1e-12);
  const Vector3d n = estimate.state.pose.orientation * kEdge.normal;
  CHECK(p.closing_speed_deviation() ==
        Approx(n.cwiseProduct(sigma.linear_velocity).norm()).epsilon(1e-10));
  CHECK((p.mean - p.value).norm() <= 1e-12);
  CHECK(cone_half_angle(p, 0.95) == 0);
  CHECK(wedge_half_angle(p, Vector3d::UnitZ(), 0.95) == 0);
}

TEST_CASE("cones of round and of flat errors are Rayleigh's and the normal distribution's") {
  TargetEstimate estimate = tumbling_box();
  estimate.state.angular_velocity.setZero();
  const double sigma = 2 * kDegree;
  const auto prediction = [&](const Vector3d& orientation) {
    EstimateDeviations deviations;
    deviations.orientation = orientation;
    return predict_contact(estimate, covariance_of(deviations), kEdge, {5.0}).front();
  };
  // The normal is x of T: errors about y and z rotate it, one about x does not.
  const ContactPrediction round = prediction({0.3, sigma, sigma});
  const ContactPrediction flat = prediction({0.3, 0, sigma});
  CHECK(cone_half_angle(round, 0.95) == Approx(sigma * std::sqrt(-2 * std::log(0.05))));
  CHECK(cone_half_angle(round, 0.5) == Approx(sigma * std::sqrt(-2 * std::log(0.5))));
  CHECK(cone_half_angle(flat, 0.95) == Approx(1.959963985 * sigma).epsilon(1e-6));
  CHECK(cone_half_angle(flat, 0.5) == Approx(0.6744897502 * sigma).epsilon(1e-6));
  const Vector3d z = estimate.state.pose.orientation * Vector3d::UnitZ();
  CHECK(wedge_half_angle(flat, z, 0.95) == Approx(1.959963985 * sigma).epsilon(1e-8));
  CHECK(wedge_half_angle(round, z, 0.95) == Approx(1.959963985 * sigma).epsilon(1e-8));
  const Vector3d y = estimate.state.pose.orientation * Vector3d::UnitY();
  CHECK(wedge_half_angle(flat, y, 0.95) <= 1e-12);
}

TEST_CASE("errors of mass and moments reach the effective mass and leave the body possible") {
  const TargetEstimate estimate = tumbling_box();
  EstimateVector error = EstimateVector::Zero();
  error[kMassError] = std::log(2.0);
  error[kMomentsError] = std::log(1.1);  // the smallest moment: z
  const TargetEstimate changed = with_error(estimate, error);
  CHECK(changed.body.mass == Approx(448));
  CHECK(changed.body.inertia.diagonal().isApprox(Vector3d(45, 40, 37 * 1.1), 1e-14));
  EstimateDeviations sigma;
  sigma.mass = 0.01;
  const ContactPrediction p = predict_contact(estimate, covariance_of(sigma), kEdge, {5.0}).front();
  const Vector3d arm = kEdge.point.cross(kEdge.normal);
  const double inverse = 1 / 224.0 + arm.dot(estimate.body.inertia.inverse() * arm);
  CHECK(p.effective_mass == Approx(1 / inverse));
  // d log(m_eff) = (1/m) / (n' W n) d log(m).
  CHECK(std::sqrt(p.spread(kEffectiveMass, kEffectiveMass)) ==
        Approx(0.01 / 224 / inverse).epsilon(1e-4));
  CHECK(cone_half_angle(p, 0.95) == 0);
}

TEST_CASE("a covariance that is none is refused") {
  const TargetEstimate estimate = tumbling_box();
  const auto predict = [&](const EstimateCovariance& covariance) {
    return predict_contact(estimate, covariance, kEdge, {5.0});
  };
  EstimateCovariance bad = EstimateCovariance::Identity() * 1e-4;
  bad(3, 3) = -1e-4;
  CHECK_THROWS_AS(predict(bad), std::invalid_argument);
  bad(3, 3) = std::nan("");
  CHECK_THROWS_AS(predict(bad), std::invalid_argument);
  bad = EstimateCovariance::Identity() * 1e-4;
  bad(0, 1) = 1e-5;
  CHECK_THROWS_AS(predict(bad), std::invalid_argument);
  bad(1, 0) = 1e-5;
  CHECK_NOTHROW(predict(bad));
  bad(0, 1) = bad(1, 0) = 2e-4;
  CHECK_THROWS_AS(predict(bad), std::invalid_argument);
}
