// Problems of the C interface.
#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <stillbase/encounter/encounter.hpp>
#include <stillbase/io/problem_file.hpp>
#include <stillbase/plan/feature.hpp>

#include "c/c_interface.hpp"

using namespace stillbase;
using stillbase::c::guarded;
using stillbase::c::needed;

stillbase_status stillbase_problem_read(const char* path, stillbase_problem** problem) {
  return guarded([&] {
    needed(path, "path");
    needed(problem, "problem");
    *problem = new stillbase_problem{read_problem(path)};
  });
}

stillbase_status stillbase_problem_parse(const char* text, const char* source, const char* urdf,
                                         stillbase_problem** problem) {
  return guarded([&] {
    needed(text, "text");
    needed(source, "source");
    needed(urdf, "urdf");
    needed(problem, "problem");
    *problem = new stillbase_problem{read_problem_text(text, source, urdf)};
  });
}

stillbase_status stillbase_problem_at_feature(const stillbase_problem* problem, const char* feature,
                                              stillbase_problem** at) {
  return guarded([&] {
    const CaptureProblem& data = needed(problem, "problem").data;
    needed(feature, "feature");
    needed(at, "at");
    CaptureProblem out = at_feature(data, feature);
    out.variables.features.clear();
    // The others of the target were not checked against the problem.
    std::vector<std::string> known = data.variables.features;
    if (known.empty() && !data.variables.feature.empty()) known = {data.variables.feature};
    if (std::find(known.begin(), known.end(), feature) == known.end()) {
      throw c::ArgumentError(fmt::format("feature: '{}' is not one of the problem's, [{}]", feature,
                                         fmt::join(known, ", ")));
    }
    *at = new stillbase_problem{std::move(out)};
  });
}

void stillbase_problem_free(stillbase_problem* problem) { delete problem; }

int stillbase_problem_joints(const stillbase_problem* problem) {
  return problem == nullptr ? 0 : problem->data.robot.n();
}

stillbase_status stillbase_problem_start(const stillbase_problem* problem,
                                         stillbase_contact* contact, double* phi) {
  return guarded([&] {
    needed(phi, "phi");
    c::write_configuration(start_configuration(needed(problem, "problem").data), contact, phi);
  });
}

stillbase_status stillbase_problem_impact(const stillbase_problem* problem,
                                          const stillbase_contact* contact, const double* phi,
                                          stillbase_impact* impact, double* Delta_phidot) {
  return guarded([&] {
    const CaptureProblem& data = needed(problem, "problem").data;
    needed(impact, "impact");
    if (!data.variables.features.empty()) {
      throw c::ArgumentError(
          "problem: leaves the contact feature open; see stillbase_problem_at_feature()");
    }
    const Configuration at = c::configuration_of(needed(contact, "contact"), phi, data.robot.n());
    c::write_impact(impact_at(data, at), impact, Delta_phidot);
  });
}
