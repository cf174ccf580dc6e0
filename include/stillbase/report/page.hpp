// Pages: headings, paragraphs, tables and figures as Markdown; a JSON document as one HTML file.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <stillbase/report/plot.hpp>

namespace stillbase {

/// Cells are plain text; every row has as many as the header.
struct TextTable {
  std::vector<std::string> header;
  std::vector<std::vector<std::string>> rows;
};

struct PageFigure {
  std::string file;  ///< name of the figure's own file, e.g. "ecdf.svg"
  std::string caption;
  PlotPanel panel;
};

struct PageSection {
  std::string heading;
  std::vector<std::string> paragraphs;  ///< before the table
  TextTable table;                      ///< no header: none
  std::vector<PageFigure> figures;
};

struct Page {
  std::string title;
  std::vector<PageSection> sections;
};

/// Tables aligned so that the text can be read as it is; figures as links to their files.
std::string page_to_markdown(const Page& page);

/// One HTML file that needs nothing from outside: the page of web/ with a JSON document as its
/// data. Its Content-Security-Policy runs the script and the style of web/ alone, known by their
/// hashes; nothing in the document becomes markup.
/// @param data_json what web/src/main.js reads: {"stillbase": version, "documents": [...]}
std::string page_html(std::string_view data_json);

/// Rows of a table as comma-separated values (RFC 4180), header first.
std::string table_to_csv(const TextTable& table);

}  // namespace stillbase
