#include "robot/xml_text.hpp"

#include <algorithm>
#include <cctype>

#include <stillbase/core/file.hpp>

namespace stillbase::urdf {

namespace {

constexpr char32_t kReplacement = 0xFFFD;

unsigned byte_of(char c) { return static_cast<unsigned char>(c); }

void append_utf8(std::string& out, char32_t code) {
  const auto tail = [&](int shift) { out += static_cast<char>(0x80u | ((code >> shift) & 0x3Fu)); };
  if (code < 0x80) {
    out += static_cast<char>(code);
  } else if (code < 0x800) {
    out += static_cast<char>(0xC0u | (code >> 6));
    tail(0);
  } else if (code < 0x10000) {
    out += static_cast<char>(0xE0u | (code >> 12));
    tail(6);
    tail(0);
  } else {
    out += static_cast<char>(0xF0u | (code >> 18));
    tail(12);
    tail(6);
    tail(0);
  }
}

/// @param text without its byte order mark
std::string from_utf16(std::string_view text, bool is_big_endian) {
  std::string out;
  const auto unit = [&](std::size_t i) -> char32_t {
    const unsigned first = byte_of(text[i]), second = byte_of(text[i + 1]);
    return is_big_endian ? first << 8 | second : second << 8 | first;
  };
  for (std::size_t i = 0; i + 1 < text.size(); i += 2) {
    char32_t code = unit(i);
    if (code >= 0xD800 && code < 0xE000) {
      const char32_t low = i + 3 < text.size() ? unit(i + 2) : 0;
      const bool is_pair = code < 0xDC00 && low >= 0xDC00 && low < 0xE000;
      code = is_pair ? 0x10000 + ((code - 0xD800) << 10) + (low - 0xDC00) : kReplacement;
      if (is_pair) i += 2;
    }
    append_utf8(out, code);
  }
  return out;
}

/// Windows 1252 has other characters than ISO 8859-1 between 0x80 and 0x9F; they are no letters of
/// names and become question marks.
std::string from_latin(std::string_view text) {
  std::string out;
  for (const char c : text) {
    const unsigned byte = byte_of(c);
    append_utf8(out, byte >= 0x80 && byte < 0xA0 ? U'?' : static_cast<char32_t>(byte));
  }
  return out;
}

/// The encoding that <?xml ...?> states, in lower case; empty: none.
std::string declared_encoding(std::string_view text) {
  const std::size_t begin = text.find("<?xml");
  if (begin == text.npos) return "";
  text = text.substr(begin, text.find("?>", begin) - begin);
  const std::size_t key = text.find("encoding");
  const std::size_t open = text.find_first_of("\"'", key == text.npos ? text.size() : key);
  if (open == text.npos) return "";
  std::string name(text.substr(open + 1, text.find(text[open], open + 1) - open - 1));
  std::transform(name.begin(), name.end(), name.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return name;
}

bool is_latin(const std::string& encoding) {
  const auto names = {"iso-8859-1", "iso8859-1", "latin1", "latin-1", "windows-1252", "cp1252"};
  return std::find(names.begin(), names.end(), encoding) != names.end();
}

/// The text with question marks in place of what is no UTF-8 in its comments.
std::string with_clean_comments(std::string text) {
  for (std::size_t begin = 0; (begin = text.find("<!--", begin)) != text.npos;) {
    const std::size_t end = std::min(text.find("-->", begin), text.size());
    while (begin < end) {
      const std::size_t bad = first_bad_byte(std::string_view(text).substr(begin, end - begin));
      if (bad == std::string_view::npos) break;
      begin += bad;
      if (byte_of(text[begin]) >= 0x80) text[begin] = '?';
      ++begin;
    }
    begin = end;
  }
  return text;
}

/// Where a piece of a text ends that begins at `begin`: after `end`, or with the text.
std::size_t end_of(std::string_view text, std::size_t begin, std::string_view end) {
  const std::size_t at = text.find(end, begin);
  return at == text.npos ? text.size() : at + end.size();
}

}  // namespace

std::string without_instructions(std::string_view text) {
  std::string out(text);
  for (std::size_t at = 0; (at = out.find('<', at)) != out.npos;) {
    const std::string_view unread = std::string_view(out).substr(at);
    if (unread.starts_with("<!--")) {
      at = end_of(out, at, "-->");
    } else if (unread.starts_with("<![CDATA[")) {
      at = end_of(out, at, "]]>");
    } else if (unread.starts_with("<?")) {
      const std::size_t end = end_of(out, at, "?>");
      std::replace_if(
          out.begin() + static_cast<long>(at), out.begin() + static_cast<long>(end),
          [](char c) { return c != '\n'; }, ' ');
      at = end;
    } else {
      ++at;
    }
  }
  return out;
}

std::optional<std::string> as_utf8(std::string_view text, Findings& findings) {
  const bool is_little = text.starts_with("\xFF\xFE"), is_big = text.starts_with("\xFE\xFF");
  if (is_little || is_big) {
    findings.remark(1, "encoding", "the text is UTF-16: it is read as UTF-8");
    return from_utf16(text.substr(2), is_big);
  }
  if (first_bad_byte(text) == std::string_view::npos) return std::nullopt;
  const std::string encoding = declared_encoding(text);
  if (is_latin(encoding)) {
    findings.remark(1, "encoding", "the text is " + encoding + ": it is read as UTF-8");
    return from_latin(text);
  }
  std::string clean = with_clean_comments(std::string(text));
  if (clean == text) return std::nullopt;
  findings.remark(1, "encoding", "bytes of comments that are no UTF-8 are read as question marks");
  return clean;
}

}  // namespace stillbase::urdf
