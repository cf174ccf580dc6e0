// The section `search`.
#include <stillbase/nlp/optimizer.hpp>

#include "io/fields/sections.hpp"

namespace stillbase::io {

void search_fields(Table& t, SearchSpec& search) {
  t("optimizer", Text(search.optimizer, nlp::optimizer_names(), "optimizers"),
    "name of a local optimizer");
  t("starts", Integer(search.starts, 1, kMaxStarts),
    "number of start points; 16 times as many where the equations leave no freedom");
  t("seed", Seed(search.seed), "same seed, same bytes");
  t("max_candidates", Integer(search.max_candidates, 1, kManyTimes), "solutions kept in the plan");
}

}  // namespace stillbase::io
