#include "c/c_interface.hpp"

#include <cmath>
#include <new>
#include <stdexcept>

#include <fmt/format.h>

#include <stillbase/core/error.hpp>

namespace stillbase::c {

namespace {

thread_local std::string last_error;

}  // namespace

stillbase_status fail(stillbase_status status, const char* text) noexcept {
  try {
    last_error = text;
  } catch (...) {
    last_error.clear();  // no memory for the text: the status has to do
  }
  return status;
}

stillbase_status fail_with_current_exception() noexcept {
  try {
    throw;
  } catch (const InputError& error) {
    return fail(STILLBASE_INPUT_REFUSED, error.what());
  } catch (const FileError& error) {
    return fail(STILLBASE_FILE_FAILED, error.what());
  } catch (const ArgumentError& error) {
    return fail(STILLBASE_WRONG_ARGUMENT, error.what());
  } catch (const std::invalid_argument& error) {
    return fail(STILLBASE_WRONG_ARGUMENT, error.what());
  } catch (const std::exception& error) {
    return fail(STILLBASE_INTERNAL_ERROR, error.what());
  } catch (...) {
    return fail(STILLBASE_INTERNAL_ERROR, "an exception without text");
  }
}

Eigen::Map<const Eigen::VectorXd> numbers(const double* data, Eigen::Index size, const char* name) {
  if (size > 0) needed(data, name);
  for (Eigen::Index i = 0; i < size; ++i) {
    if (!std::isfinite(data[i])) {
      throw ArgumentError(fmt::format("{}: number {} is not finite", name, i));
    }
  }
  return {data, size};
}

Configuration configuration_of(const stillbase_contact& contact, const double* phi, int n) {
  Configuration out;
  out.phi = numbers(phi, n, "phi");
  out.base.position = numbers(contact.base_position, 3, "base_position");
  const auto q = numbers(contact.base_orientation, 4, "base_orientation");
  if (std::abs(q.norm() - 1) > 1e-6) {
    throw ArgumentError(fmt::format("base_orientation: has the norm {}, must be 1", q.norm()));
  }
  out.base.orientation = Eigen::Quaterniond(q[0], q[1], q[2], q[3]).normalized();
  out.contact_time = numbers(&contact.contact_time, 1, "contact_time")[0];
  return out;
}

void write_configuration(const Configuration& configuration, stillbase_contact* contact,
                         double* phi) {
  copy_to(phi, configuration.phi);
  if (contact == nullptr) return;
  const Eigen::Quaterniond& q = configuration.base.orientation;
  copy_to(contact->base_position, configuration.base.position);
  copy_to(contact->base_orientation, Eigen::Vector4d(q.w(), q.x(), q.y(), q.z()));
  contact->contact_time = configuration.contact_time;
}

void write_impact(const ImpactSummary& summary, stillbase_impact* impact, double* Delta_phidot) {
  copy_to(Delta_phidot, summary.Delta_phidot);
  if (impact == nullptr) return;
  *impact = {};
  copy_to(impact->impulse, summary.Fbar);
  copy_to(impact->Delta_Omega, summary.Delta_Omega);
  copy_to(impact->total, summary.total);
  copy_to(impact->base, summary.base);
  copy_to(impact->coupling, summary.coupling);
  impact->closing_speed = summary.closing_speed;
  to_string(summary.judgement.impact_case).copy(impact->impact_case, 2);
}

}  // namespace stillbase::c

const char* stillbase_version(void) { return STILLBASE_VERSION; }
const char* stillbase_error(void) { return stillbase::c::last_error.c_str(); }
