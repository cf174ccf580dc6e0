#include "nlp/adapters.hpp"

namespace stillbase::nlp {
namespace {

/// In the order of the documentation.
Optimizers all_optimizers() {
  Optimizers all;
  for (Optimizers (*const adapter)() :
       {nlopt_optimizers, ipopt_optimizers, sqp, gradient_projection, random_search}) {
    for (std::unique_ptr<Optimizer>& optimizer : adapter()) all.push_back(std::move(optimizer));
  }
  return all;
}

}  // namespace

std::vector<std::string> optimizer_names() {
  std::vector<std::string> names;
  for (const auto& optimizer : all_optimizers()) names.push_back(optimizer->info().name);
  return names;
}

std::unique_ptr<Optimizer> make_optimizer(std::string_view name) {
  for (std::unique_ptr<Optimizer>& optimizer : all_optimizers()) {
    if (optimizer->info().name == name) return std::move(optimizer);
  }
  return nullptr;
}

}  // namespace stillbase::nlp
