#include <stillbase/collision/contact_survey.hpp>

#include <algorithm>

#include <stillbase/collision/scene.hpp>
#include <stillbase/core/random.hpp>

namespace stillbase {

namespace {

JointVectord posture_within_limits(const RobotModel& robot, Random& random) {
  JointVectord phi(robot.n());
  for (int k = 0; k < robot.n(); ++k) {
    const Joint& joint = robot.joints[k];
    const double bound = joint.is_prismatic() ? 1 : kPi;
    phi[k] = random.uniform(std::max(joint.lower, -bound), std::min(joint.upper, bound));
    if (joint.lower > bound || joint.upper < -bound) phi[k] = joint.lower;
  }
  return phi;
}

/// The scene of two links alone.
struct PairOfLinks {
  std::pair<std::string, std::string> names;
  CollisionScene scene;
  int touched = 0, was_free = 0;  ///< number of postures
};

std::vector<PairOfLinks> pairs_of_links(const RobotModel& robot) {
  std::vector<std::string> links;
  for (const CollisionShape& shape : robot.shapes) {
    if (std::find(links.begin(), links.end(), shape.link) == links.end()) {
      links.push_back(shape.link);
    }
  }
  std::vector<PairOfLinks> pairs;
  for (std::size_t a = 0; a < links.size(); ++a) {
    for (std::size_t b = a + 1; b < links.size(); ++b) {
      RobotModel two = robot;
      std::erase_if(two.shapes, [&](const CollisionShape& shape) {
        return shape.link != links[a] && shape.link != links[b];
      });
      CollisionScene scene(two, {});
      if (scene.pair_count() > 0) pairs.push_back({{links[a], links[b]}, std::move(scene)});
    }
  }
  return pairs;
}

}  // namespace

ContactSurvey survey_contacts(const RobotModel& robot, const ContactSurveyOptions& options) {
  std::vector<PairOfLinks> pairs = pairs_of_links(robot);
  Random random(options.seed);
  for (int i = 0; i < options.postures_for_never; ++i) {
    const auto kinematics = compute_kinematics<double>(robot, posture_within_limits(robot, random));
    for (PairOfLinks& pair : pairs) {
      // What can be neither any more need not be looked at.
      const bool is_often = pair.was_free <= options.postures * (1 - options.share);
      if (pair.touched > 0 && (!is_often || i >= options.postures)) continue;
      const bool touches =
          pair.scene.first_hit(kinematics, Pose{}, nullptr, options.margin).has_value();
      ++(touches ? pair.touched : pair.was_free);
    }
  }
  ContactSurvey survey;
  for (const PairOfLinks& pair : pairs) {
    const double free_share = static_cast<double>(pair.was_free) / (pair.touched + pair.was_free);
    if (free_share <= 1 - options.share) survey.always.push_back(pair.names);
    if (pair.touched == 0) survey.never.push_back(pair.names);
  }
  return survey;
}

}  // namespace stillbase
