// The optimizers that each adapter has.
#pragma once

#include <memory>
#include <vector>

#include <stillbase/nlp/optimizer.hpp>

namespace stillbase::nlp {

using Optimizers = std::vector<std::unique_ptr<Optimizer>>;

/// A new optimizer is one file that defines such a function, a line here and one in registry.cpp;
/// bench/README.md shows one.
Optimizers nlopt_optimizers();
Optimizers ipopt_optimizers();
Optimizers sqp();
Optimizers gradient_projection();
Optimizers random_search();

/// One optimizer, default constructed.
template <class One>
Optimizers single() {
  Optimizers out;
  out.push_back(std::make_unique<One>());
  return out;
}

}  // namespace stillbase::nlp
