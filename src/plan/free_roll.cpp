#include <stillbase/plan/free_roll.hpp>

#include <algorithm>

namespace stillbase {

std::optional<int> free_joint(const SolutionFamily& family) {
  const std::vector<Configuration>& points = family.points;
  if (points.size() < 2 || points.size() > 3) return std::nullopt;
  std::optional<int> out;
  for (int k = 0; k < points.front().phi.size(); ++k) {
    if (points.front().phi[k] == points[1].phi[k]) continue;
    if (out) return std::nullopt;
    out = k;
  }
  if (!out) return std::nullopt;
  const bool is_alone = std::all_of(points.begin(), points.end(), [&](Configuration point) {
    const Configuration& first = points.front();
    point.phi[*out] = first.phi[*out];
    return point.feature == first.feature && point.phi == first.phi &&
           point.contact_time == first.contact_time && point.base.position == first.base.position &&
           point.base.orientation.coeffs() == first.base.orientation.coeffs();
  });
  return is_alone ? out : std::nullopt;
}

void drop_unlisted_rolls(std::vector<Candidate>& candidates,
                         std::vector<SolutionFamily>& families) {
  std::vector<int> number(families.size(), -1);
  std::vector<SolutionFamily> kept;
  for (std::size_t i = 0; i < number.size(); ++i) {
    const bool is_listed = std::any_of(
        candidates.begin(), candidates.end(),
        [&](const Candidate& candidate) { return candidate.family == static_cast<int>(i); });
    if (!is_listed && free_joint(families[i])) continue;
    number[i] = static_cast<int>(kept.size());
    kept.push_back(std::move(families[i]));
  }
  families = std::move(kept);
  for (Candidate& candidate : candidates) {
    if (candidate.family < 0) continue;
    candidate.family = number[static_cast<std::size_t>(candidate.family)];
  }
}

}  // namespace stillbase
