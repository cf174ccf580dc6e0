#include "nlp/adapters.hpp"

namespace stillbase::nlp {
namespace {

struct Family {
  std::vector<std::string> (*names)();
  std::unique_ptr<Optimizer> (*make)(std::string_view);
};

#define STILLBASE_FAMILY(adapter) {adapter##_names, make_##adapter},
constexpr Family kFamilies[] = {STILLBASE_ADAPTERS(STILLBASE_FAMILY)};
#undef STILLBASE_FAMILY

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
