// Campaign files.
#include "io/fields/sections.hpp"

namespace stillbase::io {

void campaign_fields(Table& t, CampaignSpec& spec) {
  const auto paths = [](std::vector<std::string>& list) {
    return List(list, [](std::string& path, auto use) { use(Text(path)); },
                {.is_unique = true, .of = "files"});
  };
  format_fields(t, "stillbase.campaign");
  t("plans", paths(spec.plans), "plan files, relative to this file");
  t("problems", paths(spec.problems), "problem files: each is planned anew per seed");
  t("seeds",
    List(spec.seeds, [](std::uint64_t& seed, auto use) { use(Seed(seed)); }, {.is_unique = true}),
    "of trials and searches");
  t("trials", Integer(spec.trials, 1, 100'000'000), "per plan and seed");
  t("trials_per_case", Integer(spec.trials_per_case, 1, 1'000'000),
    "how many of them are one piece of work");
  if (t.reader() == nullptr || !spec.plans.empty() || !spec.problems.empty()) return;
  t.reader()->context().add(t.reader()->line(), "missing-key",
                            "plans or problems: there is nothing to work on");
}

}  // namespace stillbase::io
