#include <algorithm>
#include <clocale>
#include <locale>

#include <catch2/catch.hpp>

#include "io/document.hpp"
#include "io/field_reader.hpp"
#include "io/io_support.hpp"

using namespace stillbase;
using namespace stillbase::io;
using namespace stillbase::io_test;

namespace {

std::vector<Finding> parse_findings(const std::string& text, const DocumentLimits& limits = {}) {
  return findings_of([&] {
    ReadContext context{"a.yaml", {}, {}};
    parse_document(text, context, limits);
    context.throw_if_any();
  });
}

void parse_refuses(const std::string& text, const std::string& rule, int line) {
  INFO(text.substr(0, 100));
  const auto findings = parse_findings(text);
  INFO(text_of(findings));
  REQUIRE(findings.size() >= 1);
  CHECK(findings[0].rule == rule);
  CHECK(findings[0].line == line);
}

std::optional<double> number(const std::string& text, Dimension dimension) {
  ReadContext context{"a.yaml", {}, {}};
  const Node root = parse_document("x: " + text, context);
  return read_number(context, root.items[0], "x", dimension);
}

}  // namespace

TEST_CASE("what YAML offers beyond plain data is refused") {
  parse_refuses("a: 1\n---\nb: 2\n", "several-documents", 2);
  parse_refuses("a: &x 1\nb: *x\n", "anchor", 1);
  parse_refuses("base: &x {c: 1}\nb:\n  <<: *x\n", "anchor", 1);
  parse_refuses("b:\n  <<: {c: 1}\n", "merge-key", 2);
  parse_refuses("a: !!float 1\n", "tag", 1);
  parse_refuses("[a, b]: 1\n", "wrong-type", 1);
  parse_refuses("a: 1\nb: 2\na: 3\n", "duplicate-key", 3);
}

TEST_CASE("text that is not YAML is refused with its line") {
  parse_refuses("a: 1\nb: [1, 2\n", "syntax", 3);
  parse_refuses("a: 1\n\tb: 2\n", "syntax", 2);
  parse_refuses("a: 1\nb: \xff\n", "not-utf-8", 2);
  parse_refuses(std::string("a: 1\nb: \0\n", 10), "not-utf-8", 2);
  parse_refuses("a: \xed\xa0\x80\n", "not-utf-8", 1);
}

TEST_CASE("size, depth and number of values have a cap") {
  parse_refuses(std::string(2u << 20, '#'), "too-large", 0);
  parse_refuses(std::string(100, '['), "too-deep", 1);
  parse_refuses(std::string(100000, '['), "too-deep", 1);
  std::string map;
  for (int i = 0; i < 40; ++i) map += std::string(static_cast<std::size_t>(i), ' ') + "a:\n";
  CHECK(parse_findings(map + std::string(40, ' ') + "b\n")[0].rule == "too-deep");
  CHECK(parse_findings("[1, 2, 3, 4]", {.nodes = 4})[0].rule == "too-large");
  CHECK(parse_findings("[1, 2, 3]", {.nodes = 4}).empty());
}

TEST_CASE("compact JSON is read like YAML") {
  ReadContext context{"a.json", {}, {}};
  const Node root = parse_document(R"({"a":{"b":[1,-2.5e-3]},"t":"x \"y\"\n<\u003c"})", context);
  CHECK(context.findings.empty());
  CHECK(root.items[0].items[0].items[1].text == "-2.5e-3");
  CHECK(root.items[1].text == "x \"y\"\n<<");
}

TEST_CASE("units are converted and their dimension is checked") {
  CHECK(*number("180 deg", Dimension::Angle) == 3.14159265358979323846);
  CHECK(*number("90 deg/s", Dimension::AngularVelocity) == Approx(1.5707963267948966));
  CHECK(*number("2.5 min", Dimension::Time) == 150);
  CHECK(*number("-15 mm", Dimension::Length) == -0.015);
  CHECK(*number("3 kg m^2", Dimension::Inertia) == 3);
  CHECK(*number("\"2 N m s\"", Dimension::AngularImpulse) == 2);
  CHECK(*number("+1.5", Dimension::Length) == 1.5);
  CHECK(*number("10 cm", Dimension::JointPosition) == 0.1);
  CHECK_FALSE(number("1 N m", Dimension::Force));
  CHECK_FALSE(number("1 m", Dimension::Time));
  CHECK_FALSE(number("1m", Dimension::Length));
  CHECK_FALSE(number("--1", Dimension::Length));
  CHECK_FALSE(number("1 deg deg", Dimension::Angle));
  CHECK_FALSE(number("[1]", Dimension::Length));
}

TEST_CASE("numbers do not depend on the locale") {
  struct Comma : std::numpunct<char> {
    char do_decimal_point() const override { return ','; }
  };
  const std::locale before = std::locale::global(std::locale(std::locale(), new Comma));
  const auto good = number("1.5", Dimension::None);
  const auto bad = number("1,5", Dimension::None);
  std::locale::global(before);
  CHECK(good == 1.5);
  CHECK_FALSE(bad);
}

TEST_CASE("the longest numbers of JSON read back the same") {
  for (const double x : {-2.2250738585072014e-308, -1.7976931348623157e308, -0.00012345678901234567,
                         -123456789012345.67, -0.0}) {
    const std::string text = Json(x).dump();
    INFO(text);
    CHECK(Json::parse(text).get<double>() == x);
    CHECK(text.size() <= 24);
  }
  CHECK(Json(-2.2250738585072014e-308).dump() == "-2.2250738585072014e-308");
}

TEST_CASE("the text for a fingerprint leaves out keys of the document alone") {
  const Json document{{"tool", 1}, {"plan", {{"tool", 2}, {"a", {3, 4.5}}}}, {"more", nullptr}};
  CHECK(canonical(document) == R"({"more":null,"plan":{"a":[3,4.5],"tool":2},"tool":1})");
  CHECK(canonical(document, {"tool", "more"}) == R"({"plan":{"a":[3,4.5],"tool":2}})");
  CHECK(canonical(document, {"more", "plan", "tool"}) == "{}");
}

TEST_CASE("an object stays on one line of up to 100 characters with its indent") {
  // {"a": {"b": 0.5}, "c": "x...x"} takes 26 characters beside the x.
  const auto lines = [](const std::string& text) {
    const std::string out = pretty({{"a", {{"b", 0.5}}}, {"c", text}});
    return std::count(out.begin(), out.end(), '\n');
  };
  CHECK(lines(std::string(74, 'x')) == 1);
  CHECK(lines(std::string(75, 'x')) == 4);
  // What is escaped takes more room than its text.
  CHECK(lines(std::string(73, 'x') + '"') == 4);
  CHECK(lines(std::string(72, 'x') + '"') == 1);
}
