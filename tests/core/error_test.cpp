#include <catch2/catch.hpp>

#include <stillbase/core/error.hpp>

using namespace stillbase;

TEST_CASE("a finding prints as file, line, rule and message") {
  CHECK(to_string({"a.yaml", 7, "unknown-key", "x"}) == "a.yaml:7: unknown-key: x");
  CHECK(to_string({"a.yaml", 0, "too-large", "x"}) == "a.yaml: too-large: x");
}

TEST_CASE("an input error carries all findings, one line each") {
  const InputError error({{"a", 1, "r", "m"}, {"b", 0, "s", "n"}});
  CHECK(std::string(error.what()) == "a:1: r: m\nb: s: n");
  CHECK(error.findings().size() == 2);
}
