#include <stillbase/report/page.hpp>

#include <algorithm>

#include "core/escape.hpp"

namespace stillbase {

namespace {

std::size_t width_of(const std::string& utf8) {
  return static_cast<std::size_t>(std::count_if(utf8.begin(), utf8.end(), [](char c) {
    return (static_cast<unsigned char>(c) & 0xc0) != 0x80;
  }));
}

std::string padded(const std::string& text, std::size_t width) {
  return text + std::string(width - std::min(width, width_of(text)), ' ');
}

std::string markdown_cell(const std::string& text) {
  std::string out;
  for (const char c : text) out += c == '|' ? std::string("\\|") : std::string(1, c);
  return out;
}

std::string table_to_markdown(const TextTable& table) {
  std::vector<std::size_t> widths;
  for (const std::string& cell : table.header) widths.push_back(width_of(markdown_cell(cell)));
  for (const auto& row : table.rows) {
    for (std::size_t i = 0; i < widths.size(); ++i) {
      widths[i] = std::max(widths[i], width_of(markdown_cell(row.at(i))));
    }
  }
  const auto line = [&widths](const std::vector<std::string>& cells) {
    std::string out = "|";
    for (std::size_t i = 0; i < widths.size(); ++i) {
      out += " " + padded(markdown_cell(cells.at(i)), widths[i]) + " |";
    }
    return out + "\n";
  };
  std::string out = line(table.header) + "|";
  for (const std::size_t width : widths) out += std::string(width + 2, '-') + "|";
  out += "\n";
  for (const auto& row : table.rows) out += line(row);
  return out;
}

}  // namespace

std::string page_to_markdown(const Page& page) {
  std::string out = "# " + page.title + "\n";
  for (const PageSection& section : page.sections) {
    out += "\n## " + section.heading + "\n";
    for (const std::string& paragraph : section.paragraphs) out += "\n" + paragraph + "\n";
    if (!section.table.header.empty()) out += "\n" + table_to_markdown(section.table);
    for (const PageFigure& figure : section.figures) {
      out += "\n![" + figure.caption + "](" + figure.file + ")\n";
    }
  }
  return out;
}

std::string table_to_csv(const TextTable& table) {
  const auto line = [](const std::vector<std::string>& cells) {
    std::string out;
    for (std::size_t i = 0; i < cells.size(); ++i) {
      out += (i > 0 ? "," : "") + csv_field(cells[i]);
    }
    return out + "\n";
  };
  std::string out = line(table.header);
  for (const auto& row : table.rows) out += line(row);
  return out;
}

}  // namespace stillbase
