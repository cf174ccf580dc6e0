// The registry's view of the adapters.
#pragma once

#include <memory>
#include <stillbase/nlp/optimizer.hpp>
#include <string>
#include <string_view>
#include <vector>

/// A new optimizer is one file that defines ADAPTER_names() and make_ADAPTER(), and one line here;
/// bench/README.md shows one. Order of the documentation.
#define STILLBASE_ADAPTERS(ADAPTER) \
  ADAPTER(nlopt_optimizer)          \
  ADAPTER(ipopt_optimizer)          \
  ADAPTER(gradient_projection)      \
  ADAPTER(random_search)

namespace stillbase::nlp {

/// Names that the adapter knows, and the optimizer of a name; null: not one of them.
#define STILLBASE_DECLARE(adapter)            \
  std::vector<std::string> adapter##_names(); \
  std::unique_ptr<Optimizer> make_##adapter(std::string_view name);
STILLBASE_ADAPTERS(STILLBASE_DECLARE)
#undef STILLBASE_DECLARE

}  // namespace stillbase::nlp
