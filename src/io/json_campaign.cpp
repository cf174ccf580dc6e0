#include <stillbase/io/campaign_file.hpp>

#include "io/fields/sections.hpp"
#include "io/read_map.hpp"

namespace stillbase {
namespace {

using io::Json;

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
  CampaignSpec spec;
  io::read_map(text, source, [&](io::Table& t) { io::campaign_fields(t, spec); });
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
