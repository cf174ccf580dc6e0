// A page of headings, paragraphs, tables and figures, written as Markdown or as one HTML file.
#pragma once

#include <string>
#include <vector>

namespace stillbase {

/// Cells are plain text; every row has as many as the header.
struct TextTable {
  std::vector<std::string> header;
  std::vector<std::vector<std::string>> rows;
};

struct PageFigure {
  std::string file;  ///< name of the figure's own file, e.g. "ecdf.svg"
  std::string caption;
  std::string svg;
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

/// One file without anything from outside: figures inline, styles for light and dark screens and
/// for print. Text is escaped.
std::string page_to_html(const Page& page);

/// Rows of a table as comma-separated values (RFC 4180), header first.
std::string table_to_csv(const TextTable& table);

}  // namespace stillbase
