// What only a repeated search can confirm.
#pragma once

namespace stillbase::audit {

/// Begins the detail of such a claim; what the search says follows.
inline constexpr const char* kSearchSays = "the search's own record: ";

}  // namespace stillbase::audit
