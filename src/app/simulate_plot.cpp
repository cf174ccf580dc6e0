#include "app/simulate_plot.hpp"

#include "app/words.hpp"

namespace stillbase::app {

namespace {

constexpr double kLead = 0.1;  // s before the impact, as in the paper

/// The axis of the angular momentum in N, its largest component positive; z without momentum.
Vector3d momentum_axis(const TraceSample& sample) {
  const double size = sample.base.norm() + sample.coupling.norm();
  if (!(sample.total_N.norm() > 1e-9 * size)) return Vector3d::UnitZ();
  Vector3d axis = sample.total_N.normalized();
  Eigen::Index largest = 0;
  axis.cwiseAbs().maxCoeff(&largest);
  return axis[largest] < 0 ? Vector3d(-axis) : axis;
}

}  // namespace

std::vector<PlotPanel> figure_panels(const std::string& controller,
                                     const std::vector<TraceSample>& trace) {
  PlotPanel attitude{controller + ": (a) base attitude",
                     "time from the impact, s",
                     "rotation angle, deg",
                     {},
                     {{"base attitude", {}}},
                     {{0, "impact"}}};
  PlotPanel momenta{controller + ": (b) angular momenta",
                    "time from the impact, s",
                    "N m s",
                    {},
                    {{"total", {}}, {"base", {}}, {"coupling", {}}},
                    {{0, "impact"}}};
  PlotPanel rates{controller + ": (c) joint rate",
                  "time from the impact, s",
                  "norm, rad/s",
                  {},
                  {{"joint rate", {}}, {"in the null space", {}}, {"orthogonal", {}}},
                  {{0, "impact"}}};
  const Vector3d axis = momentum_axis(trace.front());
  const Eigen::Quaterniond first = trace.front().state.base.orientation;
  const double t0 = trace.front().time;
  const auto add = [&](double t, const TraceSample* sample) {
    for (PlotPanel* panel : {&attitude, &momenta, &rates}) panel->x.push_back(t);
    const auto push = [&](PlotPanel& panel, std::size_t i, double value) {
      panel.series[i].y.push_back(sample == nullptr ? 0.0 : value);
    };
    const TraceSample& s = sample == nullptr ? trace.front() : *sample;
    const Eigen::Quaterniond& R_NB = s.state.base.orientation;
    push(attitude, 0, axis.dot(rotation_log(R_NB * first.conjugate())) * kDegrees);
    push(momenta, 0, axis.dot(s.total_N));
    push(momenta, 1, axis.dot(R_NB * s.base));
    push(momenta, 2, axis.dot(R_NB * s.coupling));
    push(rates, 0, s.state.phidot.norm());
    push(rates, 1, s.rns.norm());
    push(rates, 2, s.orthogonal.norm());
  };
  add(-kLead, nullptr);
  add(0, nullptr);
  for (const TraceSample& sample : trace) add(sample.time - t0, &sample);
  return {attitude, momenta, rates};
}

}  // namespace stillbase::app
