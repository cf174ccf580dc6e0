// The same robot in DART. Twists of its free joint are [omega; v] in the base's own axes.
#include <dart/dynamics/BodyNode.hpp>
#include <dart/dynamics/FreeJoint.hpp>
#include <dart/dynamics/PrismaticJoint.hpp>
#include <dart/dynamics/RevoluteJoint.hpp>
#include <dart/dynamics/Skeleton.hpp>

#include <Eigen/Cholesky>

#include "bench_support.hpp"

namespace stillbase {

namespace {

dart::dynamics::Inertia inertia_of(const Body& body) {
  return dart::dynamics::Inertia(body.mass, body.centroid, body.inertia);
}

class Dart {
 public:
  Dart() : skeleton_(dart::dynamics::Skeleton::create()) {
    using namespace dart::dynamics;
    skeleton_->setGravity(Eigen::Vector3d::Zero());
    std::vector<BodyNode*> bodies;
    const auto pair = skeleton_->createJointAndBodyNodePair<FreeJoint>();
    pair.second->setInertia(inertia_of(robot().base));
    BodyNode* base = pair.second;
    for (int k = 0; k < robot().n(); ++k) {
      const Joint& joint = robot().joints[k];
      BodyNode* parent = joint.parent == kBase ? base : bodies[joint.parent];
      Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
      pose.linear() = joint.R.matrix();
      pose.translation() = joint.p;
      const auto place = [&](auto made) {
        made.first->setAxis(Eigen::Vector3d::UnitZ());
        made.first->setTransformFromParentBodyNode(pose);
        made.second->setInertia(inertia_of(robot().bodies[k]));
        bodies.push_back(made.second);
      };
      const BodyNode::AspectProperties body(robot().bodies[k].name);
      if (joint.is_prismatic()) {
        PrismaticJoint::Properties properties;
        properties.mName = joint.name;
        place(skeleton_->createJointAndBodyNodePair<PrismaticJoint>(parent, properties, body));
      } else {
        RevoluteJoint::Properties properties;
        properties.mName = joint.name;
        place(skeleton_->createJointAndBodyNodePair<RevoluteJoint>(parent, properties, body));
      }
    }
    hand_ = bodies.at(robot().hand_body);
    q_.setZero(6 + robot().n());
    rates_.setZero(6 + robot().n());
  }

  void set_posture(const JointVectord& phi) {
    q_.tail(phi.size()) = phi;
    skeleton_->setPositions(q_);
  }

  const Eigen::MatrixXd& mass_matrix() { return skeleton_->getMassMatrix(); }

  /// [angular; linear] in world axes, all coordinates.
  dart::math::Jacobian hand_jacobian() { return hand_->getWorldJacobian(robot().p_hand); }

  const Eigen::VectorXd& jump(const Vector6d& F) {
    llt_.compute(mass_matrix());
    const dart::math::Jacobian J = hand_jacobian();
    solution_ =
        J.topRows<3>().transpose() * F.tail<3>() + J.bottomRows<3>().transpose() * F.head<3>();
    llt_.solveInPlace(solution_);
    return solution_;
  }

  const Eigen::VectorXd& acceleration(const JointVectord& phidot) {
    rates_.tail(phidot.size()) = phidot;
    skeleton_->setVelocities(rates_);
    skeleton_->computeForwardDynamics();
    solution_ = skeleton_->getAccelerations();
    return solution_;
  }

 private:
  dart::dynamics::SkeletonPtr skeleton_;
  dart::dynamics::BodyNode* hand_ = nullptr;
  Eigen::VectorXd q_, rates_, solution_;
  Eigen::LLT<Eigen::MatrixXd> llt_;
};

Dart& dart_robot() {
  static Dart instance;
  return instance;
}

/// [omega; v; joints] to [v; omega; joints].
Eigen::VectorXd linear_first(Eigen::VectorXd x) {
  x.head<3>().swap(x.segment<3>(3));
  return x;
}

void mass_matrix_and_hand_jacobian(benchmark::State& state) {
  Postures postures;
  measure(state, [&] {
    dart_robot().set_posture(postures.next());
    benchmark::DoNotOptimize(dart_robot().mass_matrix().data());
    benchmark::DoNotOptimize(dart_robot().hand_jacobian().data());
    benchmark::ClobberMemory();
  });
}

void jump(benchmark::State& state) {
  Postures postures;
  const Vector6d F = wrench();
  measure(state, [&] {
    dart_robot().set_posture(postures.next());
    benchmark::DoNotOptimize(dart_robot().jump(F).data());
    benchmark::ClobberMemory();
  });
}

void forward_dynamics(benchmark::State& state) {
  Postures postures;
  const JointVectord phidot = joint_rates();
  measure(state, [&] {
    dart_robot().set_posture(postures.next());
    benchmark::DoNotOptimize(dart_robot().acceleration(phidot).data());
    benchmark::ClobberMemory();
  });
}

}  // namespace

/// Registers DART's rows; throws when it disagrees.
void register_dart() {
  const JointVectord phi = Postures().next();
  dart_robot().set_posture(phi);
  PeerAnswers answers;
  answers.jump = linear_first(dart_robot().jump(wrench()));
  const Eigen::MatrixXd H = dart_robot().mass_matrix();
  answers.H.resize(H.rows(), H.cols());
  for (Eigen::Index j = 0; j < H.cols(); ++j) {
    const Eigen::Index to = j < 3 ? j + 3 : (j < 6 ? j - 3 : j);
    answers.H.col(to) = linear_first(H.col(j));
  }
  answers.acceleration = linear_first(dart_robot().acceleration(joint_rates()));
  require_agreement("DART", phi, answers);
  benchmark::RegisterBenchmark("mass_matrix_and_hand_jacobian/dart", mass_matrix_and_hand_jacobian);
  benchmark::RegisterBenchmark("jump/dart", jump);
  benchmark::RegisterBenchmark("forward_dynamics/dart", forward_dynamics);
}

}  // namespace stillbase
