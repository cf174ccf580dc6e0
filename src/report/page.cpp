#include <stillbase/report/page.hpp>

#include <algorithm>

#include "report/escape.hpp"

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

std::string html_table(const TextTable& table) {
  std::string out = "<div class=\"wide\"><table>\n<thead><tr>";
  for (const std::string& cell : table.header) out += "<th>" + escape_markup(cell) + "</th>";
  out += "</tr></thead>\n<tbody>\n";
  for (const auto& row : table.rows) {
    out += "<tr>";
    for (const std::string& cell : row) out += "<td>" + escape_markup(cell) + "</td>";
    out += "</tr>\n";
  }
  return out + "</tbody></table></div>\n";
}

std::string inline_figure(const PageFigure& figure) {
  return "<figure>\n" + figure.svg + "<figcaption>" + escape_markup(figure.caption) +
         "</figcaption>\n</figure>\n";
}

constexpr const char* kStyle =
    "body{font-family:sans-serif;line-height:1.5;max-width:62rem;margin:2rem auto;padding:0 1rem;"
    "color:#222;background:#fff}h1{font-size:1.6rem}h2{font-size:1.2rem;margin-top:2.2rem}"
    ".wide{overflow-x:auto}table{border-collapse:collapse;font-size:.85rem}"
    "th,td{border:1px solid #ccc;padding:.25rem .6rem;text-align:left;white-space:nowrap}"
    "th{background:#f2f2f2}figure{margin:1rem 0;overflow-x:auto}figcaption{font-size:.85rem}"
    "svg{max-width:100%;height:auto}"
    "@media(prefers-color-scheme:dark){body{color:#ddd;background:#1b1b1b}"
    "th{background:#2a2a2a}th,td{border-color:#444}}"
    "@media print{body{max-width:none}}";

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

std::string page_to_html(const Page& page) {
  std::string out =
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>" +
      escape_markup(page.title) + "</title>\n<style>" + kStyle + "</style>\n</head>\n<body>\n<h1>" +
      escape_markup(page.title) + "</h1>\n";
  for (const PageSection& section : page.sections) {
    out += "<section>\n<h2>" + escape_markup(section.heading) + "</h2>\n";
    for (const std::string& paragraph : section.paragraphs) {
      out += "<p>" + escape_markup(paragraph) + "</p>\n";
    }
    if (!section.table.header.empty()) out += html_table(section.table);
    for (const PageFigure& figure : section.figures) out += inline_figure(figure);
    out += "</section>\n";
  }
  return out + "</body>\n</html>\n";
}

std::string table_to_csv(const TextTable& table) {
  const auto line = [](const std::vector<std::string>& cells) {
    std::string out;
    for (std::size_t i = 0; i < cells.size(); ++i) {
      if (i > 0) out += ",";
      const bool quoted = cells[i].find_first_of(",\"\r\n") != std::string::npos;
      if (!quoted) {
        out += cells[i];
        continue;
      }
      out += '"';
      for (const char c : cells[i]) out += c == '"' ? std::string("\"\"") : std::string(1, c);
      out += '"';
    }
    return out + "\n";
  };
  std::string out = line(table.header);
  for (const auto& row : table.rows) out += line(row);
  return out;
}

}  // namespace stillbase
