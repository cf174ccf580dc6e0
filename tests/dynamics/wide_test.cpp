// The kernel in wide registers against the templates.
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/tangent.hpp"
#include "dynamics/bias_kernel.hpp"
#include "dynamics/inertia_kernel.hpp"
#include "dynamics/kinematics_kernel.hpp"
#include "dynamics/wide_kernel.hpp"
#include "impact/gradient_kernel.hpp"
#include "impact/jump_kernel.hpp"
#include "support/drives.hpp"
#include "support/random_robot.hpp"

namespace stillbase {

namespace {

/// What a kernel computes of a posture.
struct Wide {
  std::vector<double> R, o, c, I, subtree, H_bphi, H_phi, total, c_b, c_phi, Omega, phidot,
      dot_Omega, phiddot, base_velocity, torques, held_torques, by_motion, by_rotation;

  Wide(const WideKernel& kernel, const RobotModel& robot, const JointVectord& phi, double mark = 0)
      : Wide(static_cast<std::size_t>(robot.n()), mark) {
    const std::vector<double> positions(phi.begin(), phi.end());
    std::vector<double> sine, cosine;
    for (const double angle : phi) {
      sine.push_back(std::sin(angle));
      cosine.push_back(std::cos(angle));
    }
    const WideJoints at{positions.data(), sine.data(), cosine.data()};
    const KnownWidePoses poses{R.data(), o.data(), c.data()};
    const std::vector<double> rates(positions), twist{0.1, -0.2, 0.3, -0.4, 0.5, -0.6};
    kernel.kinematics(robot, at, {R.data(), o.data(), c.data()});
    kernel.inertia(robot, poses,
                   {I.data(), subtree.data(), H_bphi.data(), H_phi.data(), total.data()});
    kernel.bias(robot, poses, I.data(), {twist.data(), rates.data()}, {c_b.data(), c_phi.data()});
    kernel.jump(robot, at, rates.data(), twist.data(), {Omega.data(), phidot.data()});
    const KnownWideMotion now{twist.data(), rates.data()};
    kernel.motion(robot, at, rates.data(), now, {twist.data(), rates.data()},
                  {dot_Omega.data(), phiddot.data()});
    kernel.base_velocity(robot, at, rates.data(), base_velocity.data());
    kernel.torques(robot, at, {rates.data(), sine.data()}, true, torques.data());
    kernel.torques(robot, at, {rates.data(), sine.data()}, false, held_torques.data());
    const std::vector<double> vector{0.3, 0.2, -0.1};
    kernel.motion_gradient(robot, poses, I.data(), {vector.data(), vector.data()},
                           {twist.data(), rates.data(), twist.data()},
                           {Omega.data(), rates.data(), twist.data()}, by_motion.data());
    kernel.rotation_gradient(robot, poses, subtree.data(),
                             {vector.data(), twist.data(), vector.data()}, by_rotation.data());
  }
  std::vector<std::vector<double>> all() const {
    return {R,
            o,
            c,
            I,
            subtree,
            H_bphi,
            H_phi,
            total,
            c_b,
            c_phi,
            Omega,
            phidot,
            dot_Omega,
            phiddot,
            base_velocity,
            torques,
            held_torques,
            by_motion,
            by_rotation};
  }

 private:
  /// With room for four more numbers everywhere.
  Wide(std::size_t n, double mark)
      : R(9 * n + 4, mark),
        o(3 * n + 4, mark),
        c(o),
        I(R),
        subtree(13 * n + 4, mark),
        H_bphi(6 * n + 4, mark),
        H_phi(n * n + 4, mark),
        total(13 + 4, mark),
        c_b(6 + 4, mark),
        c_phi(n + 4, mark),
        Omega(c_b),
        phidot(c_phi),
        dot_Omega(c_b),
        phiddot(c_phi),
        base_velocity(c_b),
        torques(c_phi),
        held_torques(c_phi),
        by_motion(c_phi),
        by_rotation(c_phi) {}
};

JointVectord random_positions(Random& random, int n) {
  JointVectord phi(n);
  for (double& angle : phi) angle = random.uniform(-4, 4);
  return phi;
}

/// The same robot with most joints at right angles to their parents and on the axes of these, as
/// robots are built.
RobotModel with_right_angles(Random& random, RobotModel robot) {
  for (Joint& joint : robot.joints) {
    if (random.index(5) == 0) continue;
    const int i = random.index(3), j = (i + 1 + random.index(2)) % 3;
    const auto axis_along = [&random](int row) -> Vector3d {
      return Vector3d::Unit(row) * (random.index(2) == 0 ? 1 : -1);
    };
    const Vector3d x = axis_along(i), y = axis_along(j);
    Matrix3d R;
    R << x, y, x.cross(y);
    joint.R = R;
    if (random.index(5) > 0) joint.p = axis_along(random.index(3)) * random.uniform(0, 1);
    if (random.index(5) == 0) joint.p[random.index(3)] = 0;
  }
  return robot;
}

void put_hand(RobotModel& robot, int body) {
  robot.hand_body = body;
  robot.moves_hand.assign(robot.moves_hand.size(), false);
  for (int k = body; k != kBase; k = robot.joints[static_cast<std::size_t>(k)].parent) {
    robot.moves_hand[static_cast<std::size_t>(k)] = true;
  }
}

}  // namespace

TEST_CASE("wide registers give what the templates do") {
  Random random(90);
  double worst = 0;
  const auto compare = [&worst](const auto& a, const auto& b) {
    REQUIRE(a.size() == b.size());
    REQUIRE(a.allFinite());
    const double size = b.cwiseAbs().maxCoeff();
    if (size > 0) worst = std::max(worst, (a - b).cwiseAbs().maxCoeff() / size);
  };
  for (int trial = 0; trial < 400; ++trial) {
    const int n = 1 + trial % kMaxJoints;
    const bool is_tree = trial / kMaxJoints % 2 == 0;
    RobotModel robot = with_drives(random_robot(random, n, is_tree));
    const bool has_right_angles = trial % 2 == 0;
    if (has_right_angles) robot = with_right_angles(random, robot);
    const JointVectord phi = random_positions(random, n);
    const Kinematics<double> kin = compute_kinematics<double>(robot, phi);
    const Kinematics<double> plain = kernel::kinematics<double>(robot, phi);
    CHECK(kin.n == n);
    const InertiaMatrices<double> inertia = compute_inertia<double>(robot, kin);
    const InertiaMatrices<double> expected = kernel::inertia<double>(robot, plain);
    for (std::size_t k = 0; k < static_cast<std::size_t>(n); ++k) {
      compare(kin.R[k], plain.R[k]);
      compare(kin.o[k], plain.o[k]);
      compare(kin.c[k], plain.c[k]);
      compare(inertia.I[k], expected.I[k]);
      CHECK(inertia.subtree[k].m == Approx(expected.subtree[k].m).epsilon(1e-14));
      compare(inertia.subtree[k].h, expected.subtree[k].h);
      compare(inertia.subtree[k].I, expected.subtree[k].I);
    }
    compare(kin.R_hand, plain.R_hand);
    compare(kin.r_bh, plain.r_bh);
    CHECK(inertia.mass == Approx(expected.mass).epsilon(1e-14));
    compare(inertia.r_bg, expected.r_bg);
    compare(inertia.H_b, expected.H_b);
    compare(inertia.H_bphi, expected.H_bphi);
    compare(inertia.H_phi, expected.H_phi);
    CHECK(inertia.H_phi == inertia.H_phi.transpose());
    if (has_right_angles) continue;  // zeros within a branch, too
    // Nothing between joints of different branches.
    CHECK((inertia.H_phi.array() == 0).count() == (expected.H_phi.array() == 0).count());
  }
  CHECK(worst < 1e-13);
}

TEST_CASE("bias and jump in wide registers are what the templates give") {
  Random random(91);
  double worst_bias = 0, worst_jump = 0;
  const auto compare = [](double& worst, const auto& a, const auto& b) {
    REQUIRE(a.size() == b.size());
    REQUIRE(a.allFinite());
    worst = std::max(worst, (a - b).cwiseAbs().maxCoeff() / b.cwiseAbs().maxCoeff());
  };
  for (int trial = 0; trial < 6 * kMaxJoints; ++trial) {
    const int n = 1 + trial % kMaxJoints;
    const bool is_tree = trial / kMaxJoints % 2 == 0;
    RobotModel robot = with_drives(random_robot(random, n, is_tree));
    // On a leaf, on the base, or on a body in between.
    if (trial / kMaxJoints % 3 != 0) {
      put_hand(robot, trial / kMaxJoints % 3 == 1 ? kBase : trial % n);
    }
    const JointVectord phi = random_positions(random, n), rates = random_positions(random, n);
    JointVectord added(n);
    for (double& inertia : added) inertia = random.uniform(0, 0.1);
    Vector6d twist, F;
    for (double& x : twist) x = random.uniform(-1, 1);
    for (double& x : F) x = random.uniform(-1, 1);
    const Kinematics<double> kin = compute_kinematics<double>(robot, phi);
    const InertiaMatrices<double> inertia = compute_inertia<double>(robot, kin);
    const auto bias = compute_bias<double>(robot, kin, inertia, twist, rates);
    const auto plain = kernel::bias<double>(robot, kin, inertia.I.data(), twist, rates);
    compare(worst_bias, bias.c_b, plain.c_b);
    compare(worst_bias, bias.c_phi, plain.c_phi);
    std::vector<bool> locked;
    if (trial % 7 == 0) {
      locked.assign(static_cast<std::size_t>(n), false);
      locked[static_cast<std::size_t>(trial % n)] = trial % 2 == 0;
    }
    const auto jump = compute_jump<double>(robot, phi, added, locked, F);
    const auto expected = kernel::jump<double>(robot, phi, added, locked, F);
    compare(worst_jump, jump.Delta_Omega, expected.Delta_Omega);
    compare(worst_jump, jump.Delta_phidot, expected.Delta_phidot);
  }
  CHECK(worst_bias < 1e-12);
  CHECK(worst_jump < 1e-10);
}

TEST_CASE("impact gradients in wide registers are what the templates give") {
  Random random(93);
  double worst = 0;
  for (int trial = 0; trial < 400; ++trial) {
    const int n = 1 + trial % kWideBodies;
    const bool is_tree = trial / kWideBodies % 2 == 0;
    RobotModel robot = with_drives(random_robot(random, n, is_tree));
    if (trial / kWideBodies % 3 != 0) {
      put_hand(robot, trial / kWideBodies % 3 == 1 ? kBase : trial % n);
    }
    ImpactResistance resistance{JointVectord::Constant(n, 0.05), {}};
    if (trial % 5 == 0) {
      resistance.locked.assign(static_cast<std::size_t>(n), false);
      resistance.locked[static_cast<std::size_t>(trial % n)] = true;
    }
    ResponseWeights<double> weights;
    weights.base = random.unit_vector();
    weights.total = random.unit_vector();
    weights.omega = random.unit_vector();
    weights.hand_inverse_mass = random.uniform(-1, 1);
    if (trial % 2 == 0) weights.momentum << random.unit_vector(), random.unit_vector();
    Vector6d F;
    F << random.unit_vector(), random.unit_vector();
    const JointVectord phi = random_positions(random, n);
    // Numbers with derivatives go through the templates.
    const auto gradient = [&](auto zero) {
      using S = decltype(zero);
      const auto posture = evaluate_posture<S>(robot, resistance, phi.cast<S>());
      const auto response = respond<S>(posture, F.cast<S>());
      ResponseWeights<S> cast;
      cast.base = weights.base.cast<S>();
      cast.total = weights.total.cast<S>();
      cast.omega = weights.omega.cast<S>();
      cast.hand_inverse_mass = S(weights.hand_inverse_mass);
      cast.momentum = weights.momentum.cast<S>();
      const auto found = response_gradient<S>(robot, posture, response, cast);
      JointVectord out(n);
      for (int k = 0; k < n; ++k) out[k] = value_of_number(found.phi[k]);
      return out;
    };
    const JointVectord wide = gradient(0.0), plain = gradient(Tangent(0.0));
    REQUIRE(wide.allFinite());
    worst = std::max(worst, (wide - plain).cwiseAbs().maxCoeff() / plain.cwiseAbs().maxCoeff());
  }
  CHECK(worst < 1e-9);
}

TEST_CASE("the wide kernel writes all that it computes and nothing beyond") {
  constexpr double kMark = 4711;
  Random random(92);
  for (const WideKernel* const wide : {wide_kernel_avx2(), wide_kernel_avx512()}) {
    if (wide == nullptr || !wide->runs_here()) {
      WARN("skipped: not the processor, or the build, for one of the sets of registers");
      continue;
    }
    for (int n = 1; n <= kWideBodies; ++n) {
      const RobotModel robot = random_robot(random, n, false);
      INFO(n << " joints");
      for (const auto& out : Wide(*wide, robot, random_positions(random, n), kMark).all()) {
        CHECK(std::count(out.end() - 4, out.end(), kMark) == 4);
        CHECK(std::count(out.begin(), out.end() - 4, kMark) == 0);
      }
    }
  }
}

TEST_CASE("the wide kernels of two instruction sets agree") {
  const WideKernel *const narrow = wide_kernel_avx2(), *const wide = wide_kernel_avx512();
  for (const WideKernel* const one : {narrow, wide}) {
    if (one != nullptr && one->runs_here()) continue;
    WARN("skipped: not the processor, or the build, for both sets of registers");
    return;
  }
  Random random(94);
  double worst = 0;
  for (int n = 1; n <= kWideBodies; ++n) {
    RobotModel robot = random_robot(random, n, n % 2 == 0);
    if (n % 3 == 0) robot = with_right_angles(random, robot);
    const JointVectord phi = random_positions(random, n);
    const auto a = Wide(*narrow, robot, phi).all(), b = Wide(*wide, robot, phi).all();
    for (std::size_t i = 0; i < a.size(); ++i) {
      const auto of = [](const std::vector<double>& x) {
        return Eigen::Map<const Eigen::VectorXd>(x.data(), static_cast<Eigen::Index>(x.size()));
      };
      REQUIRE(of(a[i]).allFinite());
      REQUIRE(of(b[i]).allFinite());
      const double size = of(a[i]).cwiseAbs().maxCoeff();
      worst = std::max(worst, (of(a[i]) - of(b[i])).cwiseAbs().maxCoeff() / size);
    }
  }
  CHECK(worst < 1e-9);
}

}  // namespace stillbase
