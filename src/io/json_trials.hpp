#pragma once

#include <stillbase/io/trials_file.hpp>

#include "io/json.hpp"

namespace stillbase::io {

Json trials_json(const TrialSetting& setting, const TrialReport& report);

}  // namespace stillbase::io
