#include "nlp/adapters.hpp"

namespace stillbase::nlp {
namespace {

struct Family {
  std::vector<std::string> (*names)();
  std::unique_ptr<Optimizer> (*make)(std::string_view);
};

constexpr Family kFamilies[] = {
    {nlopt_optimizer_names, make_nlopt_optimizer},
    {ipopt_optimizer_names, make_ipopt_optimizer},
    {gradient_projection_names, make_gradient_projection},
    {random_search_names, make_random_search},
};

}  // namespace

std::vector<std::string> optimizer_names() {
  std::vector<std::string> names;
  for (const Family& family : kFamilies) {
    for (std::string& name : family.names()) names.push_back(std::move(name));
  }
  return names;
}

std::unique_ptr<Optimizer> make_optimizer(std::string_view name) {
  for (const Family& family : kFamilies) {
    if (auto optimizer = family.make(name)) return optimizer;
  }
  return nullptr;
}

}  // namespace stillbase::nlp
