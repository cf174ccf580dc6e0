// Many postures at once against one after the other.
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <string>

#include <catch2/catch.hpp>

#include <stillbase/core/file.hpp>
#include <stillbase/core/random.hpp>
#include <stillbase/impact/contact.hpp>
#include <stillbase/reference/reference.hpp>
#include <stillbase/robot/urdf_reader.hpp>

#include "impact/batch_kernels.hpp"
#include "impact/null_velocities.hpp"
#include "impact/random_resistance.hpp"
#include "support/dense.hpp"
#include "support/random_robot.hpp"

namespace stillbase {
namespace {

constexpr double kTolerance = 1e-13;

ImpactBatch random_batch(Random& random, int n, int count, bool with_law) {
  ImpactBatch batch;
  batch.phi.resize(count, n);
  batch.F.resize(count, 6);
  for (int i = 0; i < count; ++i) {
    for (int k = 0; k < n; ++k) batch.phi(i, k) = random.uniform(-3, 3);
    batch.F.row(i) << random.unit_vector().transpose(), 0.3 * random.unit_vector().transpose();
  }
  if (with_law) {
    batch.approach.setConstant(count, 1.7);
    batch.target_inverse_mass = Eigen::VectorXd::LinSpaced(count, 0.01, 0.5);
  }
  return batch;
}

/// What rounding in another order may change, relative: 1e-13, or what the condition number of the
/// impact's inertia matrix makes of half a unit in the last place.
double rounding_limit(const PostureImpact<double>& posture) {
  const auto& factor = posture.factor.L;
  Eigen::MatrixXd L = factor.triangularView<Eigen::UnitLower>();
  L *= factor.diagonal().cwiseSqrt().cwiseInverse().asDiagonal();  // see factorize_cholesky()
  const Eigen::VectorXd sigma = test::jacobi_singular_values(L);
  const double condition = std::pow(sigma[0] / sigma[sigma.size() - 1], 2);
  return std::max(kTolerance, 1.1e-16 * condition);
}

/// Greatest error as a part of what is allowed.
struct Worst {
  double ratio = 0;
  void add(const Eigen::VectorXd& error, double scale, double limit) {
    const double r = error.cwiseAbs().maxCoeff() / (scale * limit);
    ratio = std::isnan(r) ? std::numeric_limits<double>::infinity() : std::max(ratio, r);
  }
};

Eigen::VectorXd number(double x) { return Eigen::VectorXd::Constant(1, x); }

/// Greatest difference of two rows, relative to the greatest entry of the second.
double difference(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  const double scale = b.cwiseAbs().maxCoeff();
  return (a - b).cwiseAbs().maxCoeff() / (scale > 0 ? scale : 1);
}

/// Distance of two neighbouring doubles at x.
double ulp(double x) {
  return std::nextafter(std::abs(x), std::numeric_limits<double>::infinity()) - std::abs(x);
}

BatchObjective angular_momentum_alone() {
  BatchObjective out;
  out.add(ResponsePart::BaseAngularMomentum, 1);
  return out;
}

struct Columns {
  ImpactBatchValues values;
  BatchObjectiveValues objective;
  BatchColumns columns;

  Columns(const ImpactBatch& batch, const BatchObjective& wanted) {
    const Eigen::Index count = batch.phi.rows();
    values.Delta_Omega.resize(count, 6);
    values.base.resize(count, 3);
    values.total.resize(count, 3);
    values.hand_inverse_mass.resize(count);
    values.p.resize(count);
    objective.psi.resize(count);
    objective.gradient.resize(count, batch.phi.cols());
    objective.gradient_F.resize(count, 6);
    columns.count = count;
    columns.phi = batch.phi.data();
    columns.F = batch.F.data();
    if (batch.approach.size() > 0) {
      columns.approach = batch.approach.data();
      columns.target_inverse_mass = batch.target_inverse_mass.data();
    }
    columns.Delta_Omega = values.Delta_Omega.data();
    columns.base = values.base.data();
    columns.total = values.total.data();
    columns.hand_inverse_mass = values.hand_inverse_mass.data();
    columns.p = values.p.data();
    set_objective(wanted, columns);
    columns.psi = objective.psi.data();
    columns.gradient = objective.gradient.data();
    columns.gradient_F = objective.gradient_F.data();
  }
};

}  // namespace

TEST_CASE("sine and cosine of packs are within 2 ulp of the library's") {
  Random random(21);
  for (const BatchKernel* kernel : batch_kernels()) {
    INFO(kernel->lanes << " lanes");
    double worst = 0;
    double x[8], s[8], c[8];
    const auto judge = [&] {
      kernel->sin_cos(x, s, c);
      for (int i = 0; i < kernel->lanes; ++i) {
        const long double wide = x[i];
        const auto error = [](double got, long double exact) {
          return static_cast<double>(std::abs(got - exact)) / ulp(static_cast<double>(exact));
        };
        worst = std::max({worst, error(s[i], std::sin(wide)), error(c[i], std::cos(wide))});
      }
    };
    for (int trial = 0; trial < 100000; ++trial) {
      for (double& angle : x) angle = random.uniform(-100, 100);
      judge();
    }
    // Where the result is small and the reduction must be sharp: next to multiples of pi/2.
    for (int k = -63; k <= 63; ++k) {
      for (double& angle : x) angle = k * M_PI / 2 + random.uniform(-1, 1) * 1e-12;
      x[0] = k * M_PI / 2;
      judge();
    }
    for (double& angle : x) angle = random.uniform(-1e-8, 1e-8);
    judge();
    CHECK(worst < 2);
  }
}

TEST_CASE("sine and cosine of packs take angles beyond their reduction, infinity and NaN") {
  for (const BatchKernel* kernel : batch_kernels()) {
    double s[8], c[8];
    double x[8] = {1e7, 0, -1e300, 1, 2, 3, 4, 5};
    kernel->sin_cos(x, s, c);
    for (int i = 0; i < kernel->lanes; ++i) {
      CHECK(s[i] == Approx(std::sin(x[i])).epsilon(0).margin(1e-15));
      CHECK(c[i] == Approx(std::cos(x[i])).epsilon(0).margin(1e-15));
    }
    x[0] = std::numeric_limits<double>::infinity();
    kernel->sin_cos(x, s, c);
    CHECK(std::isnan(s[0]));
    x[0] = std::numeric_limits<double>::quiet_NaN();
    kernel->sin_cos(x, s, c);
    CHECK(std::isnan(c[0]));
  }
}

TEST_CASE("every width of register gives the values and gradients of one posture at a time") {
  Random random(22);
  REQUIRE(batch_kernels().back() == batch_kernel_plain());
  Worst value, gradient;
  for (int trial = 0; trial < 60; ++trial) {
    const int n = 1 + random.index(16);
    const RobotModel robot = random_robot(random, n, trial % 2 == 0);
    const ImpactResistance resistance = random_resistance(random, n);
    const ImpactBatch batch = random_batch(random, n, 1 + random.index(19), trial % 3 > 0);
    const std::array<double, kResponseParts> weights_of{
        {trial % 3 == 0 ? 0.8 : 0.0, trial % 4 == 0 ? 1.0 : 0.0, trial % 4 == 1 ? 1.0 : 0.3,
         trial % 4 == 2 ? 1.0 : 0.2, trial % 5 == 0 ? 0.7 : 0.0, trial % 5 <= 1 ? 0.4 : 0.0,
         trial % 7 <= 1 ? 0.6 : 0.0, trial % 2 == 0 ? 0.5 : 0.0}};
    BatchObjective objective;
    for (std::size_t k = 0; k < kResponseParts; ++k) {
      objective.add(static_cast<ResponsePart>(k), weights_of[k]);
    }
    const auto weight_of = [&weights_of](ResponsePart part) {
      return weights_of[static_cast<std::size_t>(part)];
    };

    for (const BatchKernel* kernel : batch_kernels()) {
      Columns got(batch, objective);
      kernel->run(robot, resistance, got.columns);
      for (Eigen::Index i = 0; i < batch.phi.rows(); ++i) {
        const auto posture =
            evaluate_posture<double>(robot, resistance, JointVectord(batch.phi.row(i)));
        const auto response = respond<double>(posture, Vector6d(batch.F.row(i)));
        double p = 1;
        if (trial % 3 > 0) {
          p = normal_impulse(0, batch.approach[i], response.hand_inverse_mass,
                             batch.target_inverse_mass[i]);
        }
        ResponseWeights<double> weights;
        const Vector3d velocity = response.d.Delta_Omega.head<3>();
        weights.velocity = weight_of(ResponsePart::BaseVelocity) * p * p * velocity;
        weights.omega = weight_of(ResponsePart::BaseRate) * p * p * response.omega();
        weights.base = weight_of(ResponsePart::BaseAngularMomentum) * p * p * response.base;
        weights.total = weight_of(ResponsePart::TotalAngularMomentum) * p * p * response.total;
        const Vector6d received = posture.inertia.H_b * response.d.Delta_Omega;
        weights.momentum << weight_of(ResponsePart::ReceivedLinearMomentum) * p * p *
                                received.head<3>(),
            weight_of(ResponsePart::ReceivedAngularMomentum) * p * p * received.tail<3>();
        weights.phidot = weight_of(ResponsePart::JointRates) * p * p * response.d.Delta_phidot;
        const Vector3d force = response.F.head<3>();
        weights.force = weight_of(ResponsePart::Impulse) * p * p * force;
        const double psi =
            p * p *
            (weight_of(ResponsePart::BaseVelocity) * velocity.squaredNorm() +
             weight_of(ResponsePart::BaseRate) * response.omega().squaredNorm() +
             weight_of(ResponsePart::BaseAngularMomentum) * response.base.squaredNorm() +
             weight_of(ResponsePart::TotalAngularMomentum) * response.total.squaredNorm() +
             weight_of(ResponsePart::ReceivedLinearMomentum) * received.head<3>().squaredNorm() +
             weight_of(ResponsePart::ReceivedAngularMomentum) * received.tail<3>().squaredNorm() +
             weight_of(ResponsePart::JointRates) * response.d.Delta_phidot.squaredNorm() +
             weight_of(ResponsePart::Impulse) * force.squaredNorm()) /
            2;
        if (trial % 3 > 0) {
          weights.hand_inverse_mass =
              -2 * psi / (response.hand_inverse_mass + batch.target_inverse_mass[i]);
        }
        const auto slope = response_gradient<double>(robot, posture, response, weights);

        // Momenta and speeds beside the sizes that they are sums and differences of.
        const double limit = rounding_limit(posture);
        const Vector3d lever = posture.kinematics.r_bh - posture.inertia.r_bg;
        const double momentum =
            response.F.head<3>().norm() * lever.norm() + response.F.tail<3>().norm();
        const double speed =
            std::max(response.d.Delta_Omega.norm(), response.d.Delta_phidot.norm());
        value.add(Vector6d(got.values.Delta_Omega.row(i)) - response.d.Delta_Omega, speed, limit);
        value.add(Vector3d(got.values.base.row(i)) - response.base, momentum, limit);
        value.add(Vector3d(got.values.total.row(i)) - response.total, momentum, limit);
        value.add(number(got.values.hand_inverse_mass[i] - response.hand_inverse_mass),
                  response.hand_inverse_mass, limit);
        value.add(number(got.values.p[i] - p), p, limit);
        const double received_size = posture.inertia.H_b.norm() * speed;
        const double size =
            p * p *
            ((weight_of(ResponsePart::BaseRate) + weight_of(ResponsePart::JointRates)) * speed *
                 speed +
             (weight_of(ResponsePart::BaseAngularMomentum) +
              weight_of(ResponsePart::TotalAngularMomentum)) *
                 momentum * momentum +
             (weight_of(ResponsePart::ReceivedLinearMomentum) +
              weight_of(ResponsePart::ReceivedAngularMomentum)) *
                 received_size * received_size +
             weight_of(ResponsePart::Impulse) * force.squaredNorm());
        value.add(number(got.objective.psi[i] - psi), size, limit);
        gradient.add(JointVectord(got.objective.gradient.row(i)) - slope.phi,
                     std::max(size, slope.phi.cwiseAbs().maxCoeff()), limit);
        gradient.add(Vector6d(got.objective.gradient_F.row(i)) - slope.F,
                     std::max(size, slope.F.cwiseAbs().maxCoeff()), limit);
      }
    }
  }
  CHECK(value.ratio < 1);
  CHECK(gradient.ratio < 1);
}

TEST_CASE("on shipped robots packs differ by 1e-13, or by no more than inputs off by an ulp") {
  // Free wrists make the inertia matrix so ill-conditioned (1e5 for deos) that no two orders of
  // summation agree to 1e-13. The measure is then what the last bit of the inputs does.
  Random random(24);
  for (const char* name : {"planar_two_link_a", "planar_two_link_b", "planar_three_link",
                           "spart_sc_3dof", "servicer_6dof", "ets7", "deos", "iiwa_on_cube"}) {
    const std::string path =
        std::string(STILLBASE_SOURCE_DIR) + "/problems/robots/" + name + ".urdf";
    const RobotModel robot = read_urdf(read_text_file(path), path, "hand");
    const int n = robot.n();
    for (const double rotor : {0.0, 0.5}) {
      const ImpactResistance resistance{JointVectord::Constant(n, rotor), {}};
      const ImpactBatch batch = random_batch(random, n, 100, true);
      const auto respond_to = [&](Eigen::Index i, double ulps) {
        const auto moved = [&](double x) { return x + ulps * random.uniform(-1, 1) * ulp(x); };
        JointVectord phi(n);
        for (int k = 0; k < n; ++k) phi[k] = moved(batch.phi(i, k));
        Vector6d F;
        for (int k = 0; k < 6; ++k) F[k] = moved(batch.F(i, k));
        RobotModel other = robot;
        for (Body& body : other.bodies) body.mass = moved(body.mass);
        return respond<double>(evaluate_posture<double>(other, resistance, phi), F);
      };
      for (const BatchKernel* kernel : batch_kernels()) {
        Columns got(batch, angular_momentum_alone());
        kernel->run(robot, resistance, got.columns);
        double packs = 0, inputs = 0;
        for (Eigen::Index i = 0; i < batch.phi.rows(); ++i) {
          const auto response = respond_to(i, 0);
          const auto error = [&](const Vector6d& Delta_Omega) {
            return (Delta_Omega - response.d.Delta_Omega).norm() / response.d.Delta_Omega.norm();
          };
          packs = std::max(packs, error(got.values.Delta_Omega.row(i)));
          for (int k = 0; k < 8; ++k)
            inputs = std::max(inputs, error(respond_to(i, 1).d.Delta_Omega));
        }
        INFO(name << ", rotor inertia " << rotor << ", " << kernel->lanes << " lanes: packs "
                  << packs << ", inputs " << inputs);
        CHECK((packs < kTolerance || packs < 3 * inputs));
      }
    }
  }
}

TEST_CASE("every width of register gives the null velocities of one posture at a time") {
  Random random(25);
  double worst = 0, momentum = 0;
  for (int trial = 0; trial < 40; ++trial) {
    const int n = 4 + random.index(13), count = 1 + random.index(19);
    const RobotModel robot = random_robot(random, n, trial % 2 == 0);
    std::vector<Eigen::Index> free;  // one joint is held
    for (int k = 0; k < n; ++k) {
      if (k != trial % n) free.push_back(k);
    }
    NullVelocities batch;
    batch.phi = random_batch(random, n, count, false).phi;
    batch.wanted =
        Eigen::MatrixXd::NullaryExpr(count, n - 1, [&] { return random.uniform(-1, 1); });
    find_null_velocities(robot, free, batch);
    for (const BatchKernel* kernel : batch_kernels()) {
      Eigen::MatrixXd phidot(count, n - 1);
      Eigen::VectorXd conditioning(count);
      kernel->null_velocities(
          robot, free,
          {count, batch.phi.data(), batch.wanted.data(), phidot.data(), conditioning.data()});
      for (int i = 0; i < count; ++i) {
        const JointVectord phi = batch.phi.row(i), wanted = batch.wanted.row(i);
        const auto d = reference::compute(robot, {phi, {}, {}});
        const Eigen::MatrixXd A = d.Htilde_omegaphi(Eigen::all, free);
        const Eigen::VectorXd sigma = test::jacobi_singular_values(A);
        const double square = std::pow(sigma[2] / sigma[0], 2);
        CHECK(conditioning[i] <= square * (1 + 1e-6) + 1e-12);
        CHECK(conditioning[i] >= square * square / 8);
        if (conditioning[i] < 1e-6) continue;
        const Eigen::VectorXd expected =
            wanted - A.transpose() * (A * A.transpose()).ldlt().solve(A * wanted);
        worst = std::max(worst, (phidot.row(i).transpose() - expected).norm() * conditioning[i]);
        momentum = std::max(momentum, (A * phidot.row(i).transpose()).norm() / sigma[0]);
      }
    }
  }
  CHECK(worst < 1e-13);
  CHECK(momentum < 1e-10);
}

TEST_CASE("a batch of any size takes robots of any size") {
  Random random(23);
  for (const int n : {3, 16, 17, 40}) {
    const RobotModel robot = random_robot(random, n, true);
    const ImpactResistance free_joints{JointVectord::Zero(n), {}};
    const ImpactBatch batch = random_batch(random, n, 11, true);
    ImpactBatchValues values;
    BatchObjectiveValues objective;
    evaluate_postures(robot, free_joints, batch, values);
    evaluate_objective(robot, free_joints, batch, angular_momentum_alone(), true, objective);
    for (int i = 0; i < 11; ++i) {
      const auto response = respond<double>(
          evaluate_posture<double>(robot, free_joints, JointVectord(batch.phi.row(i))),
          Vector6d(batch.F.row(i)));
      CHECK(difference(values.Delta_Omega.row(i), response.d.Delta_Omega) < 1e-11);
      const double p = values.p[i];
      CHECK(objective.psi[i] == Approx(p * p * response.base.squaredNorm() / 2).epsilon(1e-11));
    }
    const Eigen::VectorXd with_gradients = objective.psi;
    const Eigen::MatrixXd untouched = objective.gradient;
    evaluate_objective(robot, free_joints, batch, angular_momentum_alone(), false, objective);
    CHECK(objective.psi == with_gradients);
    CHECK(objective.gradient == untouched);
  }
  ImpactBatchValues nothing;
  const RobotModel robot = random_robot(random, 3, false);
  evaluate_postures(robot, {JointVectord::Zero(3), {}}, random_batch(random, 3, 0, false), nothing);
  CHECK(nothing.base.rows() == 0);
}

#ifdef STILLBASE_TOOL
TEST_CASE("code for wide registers is shared with no other file") {
  // What the linker merges (weak symbols) must be about the pack types of that file: a function on
  // doubles would be executed by everybody, on processors without such registers too.
  const auto library =
      std::filesystem::path(STILLBASE_TOOL).parent_path().append("libstillbase.a").string();
  FILE* listing = nullptr;
  if (std::filesystem::exists(library)) {
    listing = popen(("nm -A -C '" + library + "' 2>/dev/null").c_str(), "r");
  }
  int symbols = 0;
  if (listing != nullptr) {
    char line[1 << 16];
    while (std::fgets(line, sizeof(line), listing) != nullptr) {
      const std::string text = line;
      const bool is_wide = text.find("batch_avx") != std::string::npos ||
                           text.find("lanes_avx") != std::string::npos;
      if (!is_wide) continue;
      ++symbols;
      const bool weak = text.find(" W ") != std::string::npos ||
                        text.find(" V ") != std::string::npos ||
                        text.find(" u ") != std::string::npos;
      if (text.find(" DW.ref.") != std::string::npos) continue;  // an address, not code
      INFO(text);
      CHECK((!weak || text.find("stillbase::avx2::Pack") != std::string::npos ||
             text.find("stillbase::avx512::Pack") != std::string::npos));
    }
    pclose(listing);
  }
  if (symbols == 0) WARN("no nm, no static library, or no x86: nothing to look at");
}
#endif

}  // namespace stillbase
