// A plan as a page.
#pragma once

#include <string>

#include <stillbase/plan/plan.hpp>
#include <stillbase/report/page.hpp>

namespace stillbase::app {

/// @param verification_json the object under `verification` in the plan's file; empty: none
Page plan_page(const Plan& plan, const std::string& verification_json);

}  // namespace stillbase::app
