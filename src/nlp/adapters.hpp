// The registry's view of the adapters: a new optimizer is one file and one line in registry.cpp.
#pragma once

#include <memory>
#include <stillbase/nlp/optimizer.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace stillbase::nlp {

std::vector<std::string> nlopt_optimizer_names();
std::unique_ptr<Optimizer> make_nlopt_optimizer(std::string_view name);  // null: not one of them

std::vector<std::string> ipopt_optimizer_names();
std::unique_ptr<Optimizer> make_ipopt_optimizer(std::string_view name);

std::vector<std::string> gradient_projection_names();
std::unique_ptr<Optimizer> make_gradient_projection(std::string_view name);

std::vector<std::string> random_search_names();
std::unique_ptr<Optimizer> make_random_search(std::string_view name);

}  // namespace stillbase::nlp
