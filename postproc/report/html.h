/// Parts of a self-contained HTML page: escaping, embedded images, the page around its sections. Style and script are
/// style.css and script.js beside this file and travel inside the program; without script everything can be read.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace drumsweep {

/// Text for HTML or an attribute: & < > " ' become entities; bytes that are not UTF-8 and control characters become
/// U+FFFD.
std::string escaped(std::string_view text);

/// An image as "data:TYPE;base64,...". @param type  "image/png"
std::string data_url(std::string_view bytes, const std::string& type);

struct PageSection {
  std::string id;     ///< of the anchor, one word
  std::string title;  ///< plain text
  std::string body;   ///< HTML
};

struct Page {
  std::string title;   ///< plain text
  std::string header;  ///< HTML above the sections
  std::vector<PageSection> sections;
  std::string footer;  ///< HTML
};

std::string html_of(const Page& page);

/// A table of facts: name (plain text) and value (HTML).
std::string fact_table(const std::vector<std::pair<std::string, std::string>>& facts);

/// <figure> around a picture, wide ones over the whole column.
std::string figure(const std::string& content, const std::string& caption, bool wide = false);

/// A column of a table.
struct HtmlColumn {
  std::string title;    ///< plain text, with unit
  bool number = false;  ///< right-aligned and sorted by value
  bool wraps = false;   ///< long text
};
struct HtmlCell {
  std::string text;      ///< HTML
  std::string sort_key;  ///< number, or text; empty: the text itself
};
struct HtmlTable {
  std::vector<HtmlColumn> columns;
  std::vector<std::vector<HtmlCell>> rows;
  bool sortable = false;
  std::size_t most_printed = 0;  ///< further rows are not printed on paper; 0: all are
  bool dense = false;            ///< many columns: smaller and closer
};
std::string html_of(const HtmlTable& table);

}  // namespace drumsweep
