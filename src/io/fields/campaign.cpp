// Campaign files, their cases and results.
#include <stillbase/core/error.hpp>

#include "io/fields/results.hpp"

namespace stillbase {

namespace io {

void campaign_fields(Table& t, CampaignSpec& spec) {
  const ListLimits files{.is_unique = true, .of = "files"};
  format_fields(t, "stillbase.campaign");
  t("plans", Texts(spec.plans, files), "plan files, relative to this file");
  t("problems", Texts(spec.problems, files), "problem files: each is planned anew per seed");
  t("seeds", List(spec.seeds, [](std::uint64_t& seed) { return Seed(seed); }, {.is_unique = true}),
    "of trials and searches");
  t("trials", Integer(spec.trials, 1, 100'000'000), "per plan and seed");
  t("trials_per_case", Integer(spec.trials_per_case, 1, 1'000'000), "trials of one case");
  if (t.reader() == nullptr || !spec.plans.empty() || !spec.problems.empty()) return;
  t.reader()->context().add(t.reader()->line(), "missing-key",
                            "plans or problems: there is nothing to work on");
}

namespace {

/// The file that is worked on.
void file_field(Table& t, CampaignCase& piece) {
  if (t.states("plan", !piece.plan.empty())) {
    t("plan", Text(piece.plan), "plan file", kNeeded);
  } else {
    t("problem", Text(piece.problem), "problem file", kNeeded);
  }
}

}  // namespace

static void fields(Table& t, CampaignCase& piece) {
  constexpr int kMostTrials = 100'000'000;
  file_field(t, piece);
  t("sha256", Text(piece.sha256), "of the file", kNeeded);
  t("seed", Seed(piece.seed), "", kNeeded);
  t("first", Integer(piece.first, 0, kMostTrials), "trial", kNeeded);
  t("count", Integer(piece.count, 0, kMostTrials), "trials", kNeeded);
}

static void fields(Table& t, CaseRecord& record) {
  t("case", Integer(record.number, 0, kManyTimes), "number of its line, from 0", kNeeded);
  t("status", Word(record.status, names_up_to(CaseStatus::Died)), "", kNeeded);
  t("message", WrittenIf(Text(record.text), record.status != CaseStatus::Finished),
    "why it did not finish");
}

static void fields(Table& t, CampaignGroup& group) {
  std::vector<std::string> words = words_of(plan_status_names());
  words.push_back("given");
  file_field(t, group.piece);
  t("sha256", Text(group.piece.sha256), "of the file", kNeeded);
  t("seed", Seed(group.piece.seed), "", kNeeded);
  t("plan_status", Text(group.plan_status, words, "words"), "`given`: a plan file", kNeeded);
  t("verified", Flag(group.verified), "every plan passes its verification", kNeeded);
  t("trials", Map([&](Table& m) { trials_fields(m, group.trials); }, {.name = "trials"}),
    "all trials together", kNeeded);
}

void campaign_result_fields(Table& t, MergedCampaign& merged, std::vector<CampaignGroup>& groups) {
  int count = static_cast<int>(merged.cases.size());
  bool is_complete = merged.is_complete();
  const auto numbers = [](int& number) { return Integer(number, 0, kManyTimes); };
  format_fields(t, "stillbase.campaign_result");
  t("cases_sha256", Text(merged.cases_sha256), "of the list of cases", kNeeded);
  t("case_count", Integer(count, 0, kManyTimes), "", kNeeded);
  t("complete", Flag(is_complete), "each case is there exactly once", kNeeded);
  t("missing", List<int>(merged.missing, numbers), "numbers of cases without a result", kNeeded);
  t("contradictory", List<int>(merged.contradictory, numbers),
    "numbers of cases with records that differ", kNeeded);
  t("records", maps_of(merged.records), "one per case", kNeeded);
  t("groups", maps_of(groups), "trials by file and seed", kNeeded);
}

}  // namespace io

CampaignSpec read_campaign_spec(const std::string& text, const std::string& source) {
  CampaignSpec spec;
  io::read_map(text, source, [&](io::Table& t) { io::campaign_fields(t, spec); });
  return spec;
}

std::string case_to_text(const CampaignCase& piece) {
  CampaignCase copy = piece;
  return io::written([&](io::Table& t) { fields(t, copy); }).dump();
}

CampaignCase case_from_text(const std::string& text, const std::string& source, int line) {
  CampaignCase piece;
  try {
    io::read_json(text, source, [&](io::Table& t) { fields(t, piece); });
  } catch (const InputError& error) {
    std::vector<Finding> findings = error.findings();
    for (Finding& finding : findings) finding.line = line;
    throw InputError(std::move(findings));
  }
  return piece;
}

std::string case_result_to_text(const CampaignCaseResult& result) {
  return io::Json{{"plan_status", result.plan_status},
                  {"verified", result.verified},
                  {"outcomes", io::Json::parse(result.outcomes)}}
      .dump();
}

CampaignCaseResult case_result_from_text(const std::string& text) {
  try {
    const io::Json json = io::Json::parse(text);
    return {json.at("plan_status").get<std::string>(), json.at("verified").get<bool>(),
            json.at("outcomes").dump()};
  } catch (const io::JsonError& error) {
    throw InputError({{"campaign", 0, "not-a-result", error.what()}});
  }
}

}  // namespace stillbase
