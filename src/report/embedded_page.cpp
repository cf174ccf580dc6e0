#include <stillbase/report/page.hpp>

// The built page of web/, copied into the program by the assembler: a compiler takes seconds for a
// literal of this size. STILLBASE_PAGE_FILE is its path.
asm(R"(
    .section .rodata
    .global stillbase_page_begin
    .global stillbase_page_end
stillbase_page_begin:
    .incbin ")" STILLBASE_PAGE_FILE R"("
stillbase_page_end:
    .byte 0
    .text
)");

extern "C" const char stillbase_page_begin[], stillbase_page_end[];

namespace stillbase {

namespace {

/// Where the data belong in the page.
constexpr std::string_view kMark = "@DATA@";

}  // namespace

std::string page_html(std::string_view data_json) {
  const std::string_view page(stillbase_page_begin,
                              static_cast<std::size_t>(stillbase_page_end - stillbase_page_begin));
  const std::size_t at = page.find(kMark);
  std::string out;
  out.reserve(page.size() + data_json.size() + data_json.size() / 16);
  out += page.substr(0, at);
  // In JSON "<" stands in texts alone; escaped, no text ends the element or opens a comment.
  for (const char c : data_json) {
    if (c == '<') {
      out += "\\u003c";
    } else {
      out += c;
    }
  }
  return out += page.substr(at + kMark.size());
}

}  // namespace stillbase
