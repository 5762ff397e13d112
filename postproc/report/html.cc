#include "postproc/report/html.h"

#include <fmt/format.h>

#include <cstdint>

#include "postproc/report/assets.h"

namespace drumsweep {
namespace {

std::string asset(std::string_view name) {
  for (int i = 0; i < num_page_assets; ++i)
    if (page_assets[i].name == name) return page_assets[i].text;
  return "";
}

/// Length of the UTF-8 sequence at `at`, 0 where there is none.
std::size_t sequence_at(std::string_view text, std::size_t at) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned char first = byte(at);
  const std::size_t length = first < 0x80                    ? 1
                             : first >= 0xc2 && first < 0xe0 ? 2
                             : first >= 0xe0 && first < 0xf0 ? 3
                             : first >= 0xf0 && first < 0xf5 ? 4
                                                             : 0;
  if (length == 0 || at + length > text.size()) return 0;
  for (std::size_t i = 1; i < length; ++i)
    if ((byte(at + i) & 0xc0) != 0x80) return 0;
  // No surrogates, no overlong forms, nothing above U+10FFFF.
  if (length == 3 && ((first == 0xe0 && byte(at + 1) < 0xa0) || (first == 0xed && byte(at + 1) >= 0xa0))) return 0;
  if (length == 4 && ((first == 0xf0 && byte(at + 1) < 0x90) || (first == 0xf4 && byte(at + 1) >= 0x90))) return 0;
  return length;
}

}  // namespace

std::string escaped(std::string_view text) {
  std::string out;
  out.reserve(text.size());
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t length = sequence_at(text, i);
    const char c = text[i];
    const bool control = length == 1 && static_cast<unsigned char>(c) < 0x20 && c != '\n' && c != '\t';
    if (length == 0 || control || c == 0x7f)
      out += "\xef\xbf\xbd";
    else if (c == '&')
      out += "&amp;";
    else if (c == '<')
      out += "&lt;";
    else if (c == '>')
      out += "&gt;";
    else if (c == '"')
      out += "&quot;";
    else if (c == '\'')
      out += "&#39;";
    else
      out += text.substr(i, length);
    i += length == 0 ? 1 : length;
  }
  return out;
}

std::string data_url(std::string_view bytes, const std::string& type) {
  static constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out = fmt::format("data:{};base64,", type);
  out.reserve(out.size() + bytes.size() * 4 / 3 + 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t left = bytes.size() - i;
    const auto byte = [&](std::size_t k) {
      return k < left ? std::uint32_t{static_cast<unsigned char>(bytes[i + k])} : 0u;
    };
    const std::uint32_t three = byte(0) << 16u | byte(1) << 8u | byte(2);
    for (std::size_t k = 0; k < 4; ++k) out += k <= left ? digits[three >> (18 - 6 * k) & 63u] : '=';
  }
  return out;
}

std::string html_of(const Page& page) {
  std::string nav, main;
  for (const PageSection& section : page.sections) {
    nav += fmt::format("<li><a href=\"#{}\">{}</a></li>\n", section.id, escaped(section.title));
    main += fmt::format("<section id=\"{}\">\n<h2>{}</h2>\n{}\n</section>\n", section.id, escaped(section.title),
                        section.body);
  }
  return fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<meta name=\"color-scheme\" content=\"light dark\">\n<link rel=\"icon\" href=\"data:,\">\n"
      "<title>{}</title>\n<style>\n{}</style>\n</head>\n<body>\n<nav aria-label=\"Contents\">\n<ul>\n{}</ul>\n</nav>\n"
      "<main>\n<header>\n{}\n</header>\n{}<footer>\n{}\n</footer>\n</main>\n<script>\n{}</script>\n</body>\n</html>\n",
      escaped(page.title), asset("style"), nav, page.header, main, page.footer, asset("script"));
}

std::string fact_table(const std::vector<std::pair<std::string, std::string>>& facts) {
  std::string rows;
  for (const auto& [name, value] : facts)
    rows += fmt::format("<tr><th scope=\"row\">{}</th><td>{}</td></tr>\n", escaped(name), value);
  return fmt::format("<table class=\"facts\">\n{}</table>\n", rows);
}

std::string figure(const std::string& content, const std::string& caption, bool wide) {
  return fmt::format("<figure{}>\n{}\n{}</figure>\n", wide ? " class=\"wide\"" : "", content,
                     caption.empty() ? "" : fmt::format("<figcaption>{}</figcaption>\n", caption));
}

std::string html_of(const HtmlTable& table) {
  std::string head;
  for (const HtmlColumn& column : table.columns)
    head += fmt::format("<th scope=\"col\"{}>{}</th>", column.number ? " class=\"n\"" : "", escaped(column.title));
  std::string body;
  for (std::size_t i = 0; i < table.rows.size(); ++i) {
    const bool on_paper = table.most_printed == 0 || i < table.most_printed;
    body += on_paper ? "<tr>" : "<tr class=\"screen\">";
    for (std::size_t j = 0; j < table.rows[i].size(); ++j) {
      const HtmlCell& cell = table.rows[i][j];
      body += "<td";
      if (table.columns.at(j).number) body += " class=\"n\"";
      if (table.columns[j].wraps && !cell.text.empty()) body += " class=\"w\"";
      if (table.sortable && !cell.sort_key.empty()) body += fmt::format(" data-v=\"{}\"", escaped(cell.sort_key));
      body += fmt::format(">{}</td>", cell.text);
    }
    body += "</tr>\n";
  }
  return fmt::format(
      "<div class=\"scroll{}\" tabindex=\"0\" role=\"region\" aria-label=\"table\"><table class=\"data{}{}\">\n"
      "<thead><tr>{}</tr></thead>\n<tbody>\n{}</tbody>\n</table></div>\n",
      table.rows.size() > 30 ? " tall" : "", table.sortable ? " sortable" : "", table.dense ? " dense" : "", head,
      body);
}

}  // namespace drumsweep
