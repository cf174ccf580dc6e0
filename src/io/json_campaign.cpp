#include <algorithm>
#include <cmath>

#include <stillbase/io/campaign_file.hpp>

#include "io/json.hpp"
#include "io/problem_reader.hpp"
#include "io/target_reader.hpp"

namespace stillbase {
namespace {

using io::Json;

std::vector<std::string> read_paths(io::MapReader& map, const std::string& key) {
  std::vector<std::string> paths;
  const io::Node* list = map.child(key);
  if (list == nullptr) return paths;
  if (list->kind != io::Node::Kind::Sequence) {
    map.context().add(list->line, "wrong-type", key + ": must be a list of files");
    return paths;
  }
  for (const io::Node& item : list->items) {
    const auto path = io::read_text(map.context(), item, key);
    if (!path) continue;
    if (std::find(paths.begin(), paths.end(), *path) != paths.end()) {
      map.context().add(item.line, "duplicate-name", key + ": '" + *path + "' is already named");
    }
    paths.push_back(*path);
  }
  return paths;
}

std::vector<std::uint64_t> read_seeds(io::MapReader& map) {
  std::vector<std::uint64_t> seeds;
  const io::Node* list = map.child("seeds");
  if (list == nullptr) return {1};
  const auto numbers =
      io::read_numbers(map.context(), *list, "seeds", io::Dimension::None, -1, {0, 9e15});
  if (!numbers) return {1};
  for (const double number : *numbers) {
    if (number != std::floor(number)) {
      map.context().add(list->line, "not-an-integer", "seeds: must be whole numbers");
    }
    const auto seed = static_cast<std::uint64_t>(number);
    if (std::find(seeds.begin(), seeds.end(), seed) != seeds.end()) {
      map.context().add(list->line, "duplicate-name",
                        "seeds: " + std::to_string(seed) + " is already named");
    }
    seeds.push_back(seed);
  }
  return seeds;
}

template <class Read>
auto parsed(const std::string& text, const char* rule, Read&& read) {
  try {
    return read(Json::parse(text));
  } catch (const io::JsonError& error) {
    throw InputError({{"campaign", 0, rule, error.what()}});
  }
}

}  // namespace

CampaignSpec read_campaign_spec(const std::string& text, const std::string& source) {
  io::ReadContext context{source, {}, {}};
  const io::Node root = io::parse_document(text, context);
  io::MapReader map(context, root, "");
  io::read_format(map, "stillbase.campaign");
  CampaignSpec spec;
  spec.plans = read_paths(map, "plans");
  spec.problems = read_paths(map, "problems");
  spec.seeds = read_seeds(map);
  map.integer("trials", spec.trials, 1, 100'000'000);
  map.integer("trials_per_case", spec.trials_per_case, 1, 1'000'000);
  if (spec.plans.empty() && spec.problems.empty()) {
    context.add(map.line(), "missing-key", "plans or problems: there is nothing to work on");
  }
  map.finish();
  context.throw_if_any();
  return spec;
}

std::string case_to_text(const CampaignCase& piece) {
  Json json;
  if (!piece.plan.empty()) json["plan"] = piece.plan;
  if (!piece.problem.empty()) json["problem"] = piece.problem;
  json["sha256"] = piece.sha256;
  json["seed"] = piece.seed;
  json["first"] = piece.first;
  json["count"] = piece.count;
  return json.dump();
}

CampaignCase case_from_text(const std::string& text) {
  return parsed(text, "not-a-case", [](const Json& json) {
    CampaignCase piece;
    piece.plan = json.value("plan", "");
    piece.problem = json.value("problem", "");
    piece.sha256 = json.at("sha256").get<std::string>();
    piece.seed = json.at("seed").get<std::uint64_t>();
    piece.first = json.at("first").get<int>();
    piece.count = json.at("count").get<int>();
    if (piece.plan.empty() == piece.problem.empty() || piece.first < 0 || piece.count < 0) {
      throw InputError({{"campaign", 0, "not-a-case", "neither a plan nor a problem"}});
    }
    return piece;
  });
}

std::string case_result_to_text(const CampaignCaseResult& result) {
  return Json{{"plan_status", result.plan_status},
              {"verified", result.verified},
              {"outcomes", Json::parse(result.outcomes)}}
      .dump();
}

CampaignCaseResult case_result_from_text(const std::string& text) {
  return parsed(text, "not-a-result", [](const Json& json) {
    CampaignCaseResult result;
    result.plan_status = json.at("plan_status").get<std::string>();
    result.verified = json.at("verified").get<bool>();
    result.outcomes = json.at("outcomes").dump();
    return result;
  });
}

}  // namespace stillbase
