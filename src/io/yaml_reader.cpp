// The only file that knows yaml-cpp. Its event interface is used instead of its nodes: the nodes
// keep duplicate keys, resolve aliases and forget quotes without a word.
#include <algorithm>
#include <sstream>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/mark.h>
#include <yaml-cpp/parser.h>

#include <stillbase/core/file.hpp>

#include "io/document.hpp"
#include "io/json.hpp"

namespace stillbase::io {

namespace {

/// Commas, colons and opening brackets outside of quotes in a JSON text: as many as its keys and
/// values, or a few more.
std::size_t separators(std::string_view text) {
  std::size_t count = 0;
  bool is_quoted = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (is_quoted && c == '\\') {
      ++i;
    } else if (c == '"') {
      is_quoted = !is_quoted;
    } else if (!is_quoted && (c == ',' || c == ':' || c == '[' || c == '{')) {
      ++count;
    }
  }
  return count;
}

class TreeBuilder : public YAML::EventHandler {
 public:
  TreeBuilder(ReadContext& context, const DocumentLimits& limits)
      : context_(context), limits_(limits) {}

  Node root;
  int documents = 0;

  void OnDocumentStart(const YAML::Mark& mark) override {
    if (++documents == 2) {
      context_.add(mark.line + 1, "several-documents", "one document per file is allowed");
    }
  }
  void OnDocumentEnd() override {}

  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    refuse_anchor(mark, anchor);
    add(make(Node::Kind::Null, mark));
  }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t) override {
    refuse_anchor(mark, 1);
    add(make(Node::Kind::Null, mark));
  }
  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                const std::string& value) override {
    refuse_anchor(mark, anchor);
    // "?" is a plain scalar, "!" one in quotes or a block.
    if (tag != "?" && tag != "!" && !tag.empty()) refuse_tag(mark, tag);
    Node node = make(tag == "!" ? Node::Kind::Quoted : Node::Kind::Plain, mark);
    node.text = value;
    add(std::move(node));
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value) override {
    open(Node::Kind::Sequence, mark, tag, anchor);
  }
  void OnSequenceEnd() override { close(); }
  void OnMapStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value) override {
    open(Node::Kind::Map, mark, tag, anchor);
  }
  void OnMapEnd() override {
    report_duplicates(stack_.back());
    close();
  }

 private:
  Node make(Node::Kind kind, const YAML::Mark& mark) {
    if (++count_ > limits_.nodes) {
      fail(mark, "too-large", fmt::format("more than {} values", limits_.nodes));
    }
    Node node;
    node.kind = kind;
    node.line = mark.line + 1;
    return node;
  }

  void open(Node::Kind kind, const YAML::Mark& mark, const std::string& tag,
            YAML::anchor_t anchor) {
    refuse_anchor(mark, anchor);
    if (tag != "?" && tag != "!" && !tag.empty()) refuse_tag(mark, tag);
    if (static_cast<int>(stack_.size()) >= limits_.depth) {
      fail(mark, "too-deep", fmt::format("nested deeper than {} levels", limits_.depth));
    }
    stack_.push_back(make(kind, mark));
  }

  void close() {
    Node node = std::move(stack_.back());
    stack_.pop_back();
    add(std::move(node));
  }

  void add(Node node) {
    if (stack_.empty()) {
      if (documents < 2) root = std::move(node);
      return;
    }
    Node& parent = stack_.back();
    if (parent.kind == Node::Kind::Map && parent.keys.size() == parent.items.size()) {
      const bool is_text = node.kind == Node::Kind::Plain || node.kind == Node::Kind::Quoted;
      if (!is_text) {
        context_.add(node.line, "wrong-type", "a key must be text");
      } else if (node.text == "<<" && node.kind == Node::Kind::Plain) {
        context_.add(node.line, "merge-key", "merge keys ('<<') are not allowed");
      }
      parent.keys.push_back(std::move(node.text));
      parent.key_lines.push_back(node.line);
    } else {
      // An absent value is marked where the next token starts.
      if (parent.kind == Node::Kind::Map && node.kind == Node::Kind::Null) {
        node.line = parent.key_lines.back();
      }
      parent.items.push_back(std::move(node));
    }
  }

  void report_duplicates(const Node& map) {
    std::vector<std::size_t> order(map.keys.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return map.keys[a] < map.keys[b]; });
    for (std::size_t i = 1; i < order.size(); ++i) {
      if (map.keys[order[i]] != map.keys[order[i - 1]]) continue;
      context_.add(map.key_lines[order[i]], "duplicate-key",
                   fmt::format("'{}' is already stated in line {}", map.keys[order[i]],
                               map.key_lines[order[i - 1]]));
    }
  }

  void refuse_anchor(const YAML::Mark& mark, YAML::anchor_t anchor) {
    if (anchor != 0) {
      context_.add(mark.line + 1, "anchor", "anchors (&) and aliases (*) are not allowed");
    }
  }
  void refuse_tag(const YAML::Mark& mark, const std::string& tag) {
    context_.add(mark.line + 1, "tag", fmt::format("tags are not allowed: '{}'", tag));
  }
  [[noreturn]] void fail(const YAML::Mark& mark, std::string rule, std::string message) {
    context_.add(mark.line + 1, std::move(rule), std::move(message));
    throw InputError(context_.findings);
  }

  ReadContext& context_;
  const DocumentLimits& limits_;
  std::vector<Node> stack_;
  std::size_t count_ = 0;
};

}  // namespace

Node parse_document(std::string_view text, ReadContext& context, const DocumentLimits& limits) {
  if (text.size() > limits.bytes) {
    context.add(0, "too-large", fmt::format("more than {} bytes", limits.bytes));
    throw InputError(context.findings);
  }
  const std::size_t bad = first_bad_byte(text);
  if (bad != std::string_view::npos) {
    const auto line = 1 + std::count(text.begin(), text.begin() + static_cast<long>(bad), '\n');
    context.add(static_cast<int>(line), "not-utf-8",
                fmt::format("byte 0x{:02x} is not allowed; the text must be UTF-8",
                            static_cast<unsigned char>(text[bad])));
    throw InputError(context.findings);
  }
  if (text.size() > DocumentLimits{}.bytes) {
    // Plans are large and JSON. Anything else would keep the parser busy for minutes, and it keeps
    // all of a line in memory before the first value is counted.
    if (!is_json(text)) {
      context.add(0, "syntax",
                  fmt::format("more than {} bytes that are not JSON", DocumentLimits{}.bytes));
    } else if (separators(text) > limits.nodes) {
      context.add(0, "too-large", fmt::format("more than {} values", limits.nodes));
    }
    context.throw_if_any();
  }
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  if (first != std::string_view::npos && text[first] == '<') {
    context.add(0, "syntax",
                "this is XML and neither YAML nor JSON; a robot file is named by robot.file of a "
                "problem");
    throw InputError(context.findings);
  }
  TreeBuilder builder(context, limits);
  try {
    std::istringstream stream{std::string(text)};
    YAML::Parser parser(stream);
    // The second call only finds out whether there is a second document.
    if (parser.HandleNextDocument(builder)) parser.HandleNextDocument(builder);
  } catch (const YAML::Exception& error) {
    context.add(error.mark.line + 1, "syntax", error.msg);
    throw InputError(context.findings);
  }
  return std::move(builder.root);
}

void refuse_other_format(const Node& root, const std::string& source, const std::string& own) {
  const Node* format = root.find("format");
  if (format == nullptr || format->text.rfind("stillbase.", 0) != 0 || format->text == own) return;
  std::string message = fmt::format("is '{}'; must be '{}'", format->text, own);
  if (own == "stillbase.plan" && format->text == "stillbase.problem") {
    message = "this is a problem file; make a plan of it first (stillbase plan)";
  }
  throw InputError({{source, format->line, "format", message}});
}

}  // namespace stillbase::io
