// The check of one posture of an approach path against robot, base and moving target: by our scene,
// and by FCL alone as its user would write it.
#include "bench_support.hpp"

#include <algorithm>
#include <array>
#include <memory>
#include <stdexcept>

#include <fcl/broadphase/broadphase_dynamic_AABB_tree.h>
#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/capsule.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/narrowphase/collision.h>
#include <fcl/narrowphase/distance.h>

#include <stillbase/collision/scene.hpp>
#include <stillbase/encounter/target_motion.hpp>
#include <stillbase/io/problem_file.hpp>
#include <stillbase/planner/planner.hpp>

namespace stillbase {

namespace {

/// Everything where it is at one instant.
struct PlacedPosture {
  JointVectord phi;
  Kinematics<double> kinematics;
  Pose base, target;  ///< in N
};

/// The plan's path to problems/iiwa_client_50.yaml, and the straight line to the same contact in
/// the same time, on which the arm passes through the target.
struct CheckedPath {
  CaptureProblem problem;
  CollisionScene scene;
  double margin;
  std::vector<PlacedPosture> postures;
  explicit CheckedPath(const CaptureProblem& of)
      : problem(of), scene(of), margin(least_distance(of.approach)) {
    PlannerOptions options;
    options.jobs = 1;
    const Plan plan = make_plan(problem, options);
    const Approach& approach = plan.approach;
    if (approach.status != ApproachStatus::Found) throw std::runtime_error("no path to check");
    const TargetMotion motion = encounter_motion(problem, plan.configuration).value();
    const std::size_t count = approach.times.size();
    const auto add = [&](std::size_t i, const JointVectord& phi) {
      postures.push_back({phi, compute_kinematics<double>(problem.robot, phi),
                          approach.base_poses[i], motion.state(approach.times[i]).pose});
    };
    for (std::size_t i = 0; i < count; ++i) add(i, approach.joint_positions[i]);
    const JointVectord &start = approach.joint_positions.front(),
                       &end = approach.joint_positions.back();
    for (std::size_t i = 0; i < count; ++i) {
      add(i, start + static_cast<double>(i) / static_cast<double>(count - 1) * (end - start));
    }
  }
};

fcl::Transform3d transform(const Pose& pose) {
  fcl::Transform3d T = fcl::Transform3d::Identity();
  T.linear() = pose.orientation.toRotationMatrix();
  T.translation() = pose.position;
  return T;
}

const CheckedPath& checked_path() {
  static const CheckedPath path(read_problem(STILLBASE_SOURCE_DIR "/problems/iiwa_client_50.yaml"));
  return path;
}

/// The same shapes and allowed pairs in FCL.
class FclScene {
 public:
  explicit FclScene(const CheckedPath& path) : path_(path) {
    const CaptureProblem& problem = path.problem;
    for (const CollisionShape& shape : problem.robot.shapes) {
      add(shape.body, shape.pose, shape.geometry);
    }
    robot_count_ = objects_.size();
    for (const TargetShape& shape : problem.target->shapes) add(kBase, shape.pose, shape.geometry);
    is_pair_.assign(objects_.size(), std::vector<bool>(objects_.size()));
    for (const auto& [a, b] : path.scene.shape_pairs()) {
      is_pair_[a][b] = is_pair_[b][a] = true;
      pairs_.push_back({a, b});
    }
    for (std::size_t i = 0; i < objects_.size(); ++i) {
      objects_[i]->setUserData(reinterpret_cast<void*>(i));
      manager_.registerObject(objects_[i].get());
    }
    manager_.setup();
  }

  /// Whether a pair is closer than `margin`, by all pairs one after the other.
  bool hits_by_pairs(const PlacedPosture& posture, double margin) {
    move_to(posture);
    return std::any_of(pairs_.begin(), pairs_.end(), [&](const auto& pair) {
      return is_checked(pair[0], pair[1]) &&
             distance(*objects_[pair[0]], *objects_[pair[1]]) < margin;
    });
  }

  /// The same of the pairs whose boxes in the manager's tree are closer than `margin`.
  bool hits_by_tree(const PlacedPosture& posture, double margin) {
    move_to(posture);
    for (const auto& object : objects_) object->computeAABB();
    manager_.update();
    Query query{this, margin, false};
    manager_.distance(&query, &FclScene::on_near_pair);
    return query.hits;
  }

  /// Whether a pair overlaps, without any margin.
  bool overlaps_by_tree(const PlacedPosture& posture) {
    move_to(posture);
    for (const auto& object : objects_) object->computeAABB();
    manager_.update();
    Query query{this, 0, false};
    manager_.collide(&query, &FclScene::on_touching_boxes);
    return query.hits;
  }

 private:
  struct Query {
    const FclScene* scene;
    double margin;
    bool hits;
  };

  void add(int body, const Pose& pose, const Geometry& geometry) {
    std::shared_ptr<fcl::CollisionGeometryd> shape;
    if (const auto* sphere = std::get_if<Sphere>(&geometry)) {
      shape = std::make_shared<fcl::Sphered>(sphere->radius);
    } else if (const auto* capsule = std::get_if<Capsule>(&geometry)) {
      shape = std::make_shared<fcl::Capsuled>(capsule->radius, capsule->length);
    } else if (const auto* box = std::get_if<Box>(&geometry)) {
      shape = std::make_shared<fcl::Boxd>(box->size);
    } else {
      throw std::runtime_error("a shape that this benchmark does not know");
    }
    objects_.push_back(std::make_unique<fcl::CollisionObjectd>(shape));
    bodies_.push_back(body);
    in_carrier_.push_back(transform(pose));
  }

  void move_to(const PlacedPosture& posture) {
    const Kinematics<double>& kinematics = posture.kinematics;
    const fcl::Transform3d base = transform(posture.base), target = transform(posture.target);
    for (std::size_t i = 0; i < objects_.size(); ++i) {
      fcl::Transform3d carrier = i < robot_count_ ? base : target;
      if (bodies_[i] != kBase) {
        fcl::Transform3d body = fcl::Transform3d::Identity();
        body.linear() = kinematics.R[bodies_[i]];
        body.translation() = kinematics.o[bodies_[i]];
        carrier = carrier * body;
      }
      objects_[i]->setTransform(carrier * in_carrier_[i]);
    }
    const ContactFeature& feature = path_.problem.target->features.front();
    const double to_feature =
        (posture.base * kinematics.r_bh - posture.target * feature.point).norm();
    hand_may_touch_ = to_feature <= path_.problem.approach.contact_allowance;
  }

  bool is_checked(std::size_t a, std::size_t b) const {
    if (!hand_may_touch_ || (a < robot_count_) == (b < robot_count_)) return true;
    return bodies_[std::min(a, b)] != path_.problem.robot.hand_body;
  }
  bool is_pair(const fcl::CollisionObjectd& a, const fcl::CollisionObjectd& b) const {
    const auto i = reinterpret_cast<std::size_t>(a.getUserData());
    const auto j = reinterpret_cast<std::size_t>(b.getUserData());
    return is_pair_[i][j] && is_checked(i, j);
  }

  static double distance(const fcl::CollisionObjectd& a, const fcl::CollisionObjectd& b) {
    const fcl::DistanceRequestd request(false, false, 0.0, 0.0, 1e-6, fcl::GST_LIBCCD);
    fcl::DistanceResultd result;
    return fcl::distance(&a, &b, request, result);
  }

  /// Of the manager's pairs whose boxes are closer than `least`.
  static bool on_near_pair(fcl::CollisionObjectd* a, fcl::CollisionObjectd* b, void* data,
                           double& least) {
    auto& query = *static_cast<Query*>(data);
    least = query.margin;  // pairs whose boxes are further apart are not asked for any more
    query.hits = query.scene->is_pair(*a, *b) && distance(*a, *b) < query.margin;
    return query.hits;
  }

  static bool on_touching_boxes(fcl::CollisionObjectd* a, fcl::CollisionObjectd* b, void* data) {
    auto& query = *static_cast<Query*>(data);
    if (!query.scene->is_pair(*a, *b)) return false;
    const fcl::CollisionRequestd request;
    fcl::CollisionResultd result;
    query.hits = fcl::collide(a, b, request, result) > 0;
    return query.hits;
  }

  const CheckedPath& path_;
  std::size_t robot_count_ = 0;
  std::vector<std::unique_ptr<fcl::CollisionObjectd>> objects_;
  std::vector<int> bodies_;
  std::vector<fcl::Transform3d> in_carrier_;
  std::vector<std::array<std::size_t, 2>> pairs_;
  std::vector<std::vector<bool>> is_pair_;
  fcl::DynamicAABBTreeCollisionManagerd manager_;
  bool hand_may_touch_ = false;
};

/// Our verdict.
bool hits(const CheckedPath& path, const PlacedPosture& posture, double margin) {
  return path.scene.first_hit(posture.kinematics, posture.base, &posture.target, margin)
      .has_value();
}

/// Times `check` on one posture after the other, once its verdicts are those of our scene.
template <class Check>
void measure_checks(benchmark::State& state, double margin, const Check& check) {
  const CheckedPath& path = checked_path();
  int hit = 0;
  for (const PlacedPosture& posture : path.postures) {
    const bool is_hit = hits(path, posture, margin);
    if (check(posture) != is_hit) {
      state.SkipWithError("verdicts differ from ours");
      return;
    }
    if (is_hit) ++hit;
  }
  std::size_t i = 0;
  measure(state, [&] {
    benchmark::DoNotOptimize(check(path.postures[i]));
    if (++i == path.postures.size()) i = 0;
  });
  state.counters["hits_percent"] = 100.0 * hit / static_cast<double>(path.postures.size());
}

/// By our scene, from the poses of the bodies on.
void path_posture(benchmark::State& state) {
  const CheckedPath& path = checked_path();
  measure_checks(state, path.margin,
                 [&](const PlacedPosture& posture) { return hits(path, posture, path.margin); });
}
BENCHMARK(path_posture);

/// The same from joint positions on.
void path_posture_from_joints(benchmark::State& state) {
  const CheckedPath& path = checked_path();
  measure_checks(state, path.margin, [&](const PlacedPosture& posture) {
    const auto kinematics = compute_kinematics<double>(path.problem.robot, posture.phi);
    return path.scene.first_hit(kinematics, posture.base, &posture.target, path.margin).has_value();
  });
}
BENCHMARK(path_posture_from_joints);

/// By FCL's distances: of every pair, and of the pairs that its broadphase leaves.
void path_posture_fcl(benchmark::State& state,
                      bool (FclScene::*hits_by_fcl)(const PlacedPosture&, double)) {
  const CheckedPath& path = checked_path();
  FclScene scene(path);
  measure_checks(state, path.margin, [&](const PlacedPosture& posture) {
    return (scene.*hits_by_fcl)(posture, path.margin);
  });
}
BENCHMARK_CAPTURE(path_posture_fcl, pairs, &FclScene::hits_by_pairs)
    ->Name("path_posture/fcl_pairs");
BENCHMARK_CAPTURE(path_posture_fcl, tree, &FclScene::hits_by_tree)->Name("path_posture/fcl_tree");

/// Overlap alone, which is less than a path asks for.
void path_posture_fcl_overlap(benchmark::State& state) {
  FclScene scene(checked_path());
  measure_checks(state, 0,
                 [&](const PlacedPosture& posture) { return scene.overlaps_by_tree(posture); });
}
BENCHMARK(path_posture_fcl_overlap)->Name("path_posture/fcl_overlap");

}  // namespace
}  // namespace stillbase
