#include "postproc/gnuplot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "core/io/durable_file.h"
#include "postproc/child_process.h"

namespace drumsweep {
namespace {

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
    text.replace(at, from.size(), to);
  return text;
}

/// Text in an XML attribute.
std::string escaped(std::string text) {
  for (const auto& [from, to] : {std::pair{"&", "&amp;"}, {"<", "&lt;"}, {">", "&gt;"}, {"\"", "&quot;"}})
    text = replaced(std::move(text), from, to);
  return text;
}

}  // namespace

const char* const pale_viridis =
    "set palette defined (0 '#987399', 1 '#9985b8', 2 '#94a0bf', 3 '#8bb2c1', 4 '#85c2bf', 5 '#89d2b9', "
    "6 '#a6e1a8', 7 '#d2ec8d', 8 '#fef187')\n";

std::string draw(const FigureFiles& figure, const std::string& picture) {
  // A folder of its own, so that a failed run leaves nothing behind.
  const ScratchFolder scratch;
  for (const auto& [name, text] : figure.data) write_durably(scratch.path / name, text);
  write_durably(scratch.path / "figure.gp", figure.script);
  // -d: without the user's start-up file.
  run_program(scratch.path, {"gnuplot", "-d", "figure.gp"},
              "install gnuplot, or write the figure as .gp and draw it elsewhere");
  std::string drawn = read_whole_file(scratch.path / picture);
  if (drawn.empty()) throw std::runtime_error("gnuplot ended without an error but drew nothing");
  if (!picture.ends_with(".svg")) return drawn;
  // Cells are cells: no smoothing. And a font that every viewer has where the first is missing.
  drawn = replaced(std::move(drawn), "<image ", "<image style=\"image-rendering:pixelated\" ");
  return replaced(std::move(drawn), "font-family=\"DejaVu Sans\"", "font-family=\"DejaVu Sans, sans-serif\"");
}

std::string for_page(const std::string& svg, const PageFigure& page) {
  std::string out = svg.substr(std::min(svg.size(), svg.find("<svg")));
  // Black is the page's ink. Marks on coloured ground are nearly black on purpose (#101010) and stay.
  out = replaced(std::move(out), "color=\"black\"", "color=\"currentColor\"");
  for (const char* property : {"fill", "stroke"})
    out = replaced(std::move(out), fmt::format("{}=\"black\"", property), fmt::format("{}=\"currentColor\"", property));
  for (const char* black :
       {"'black'", "'rgb(  0,   0,   0)'", "\"rgb(  0,   0,   0)\"", "'rgb(0,0,0)'", "\"rgb(0,0,0)\""})
    out = replaced(std::move(out), black, "\"currentColor\"");
  out = replaced(std::move(out), "font-family=\"DejaVu Sans, sans-serif\"", "font-family=\"sans-serif\"");
  for (const char* quote : {"'", "\""})
    for (const std::string before : {"id=", "xlink:href=", "filter="}) {
      const std::string hash = before == "id=" ? "" : before == "filter=" ? "url(#" : "#";
      out = replaced(std::move(out), fmt::format(" {}{}{}", before, quote, hash),
                     fmt::format("\n{}{}{}{}", before, quote, hash, page.id_prefix));
    }
  // gnuplot names every curve in a tooltip of its own: words that mean nothing to a reader of the page.
  for (std::size_t at = out.find("<title>"); at != std::string::npos; at = out.find("<title>", at))
    out.erase(at, out.find("</title>", at) + 8 - at);
  // What gnuplot's own script would show when a mark is pointed at, the browser shows by itself.
  const std::string begins = "<g onmousemove=\"gnuplot_svg.showHypertext(evt,'",
                    ends = "')\" onmouseout=\"gnuplot_svg.hideHypertext()\">";
  for (std::size_t at = out.find(begins); at != std::string::npos; at = out.find(begins, at)) {
    const std::size_t text = at + begins.size(), end = out.find(ends, text);
    if (end == std::string::npos) break;
    out.replace(at, end + ends.size() - at, fmt::format("<g><title>{}</title>", out.substr(text, end - text)));
  }
  // The drawing's own size is in viewBox; width and height are the page's.
  const std::size_t head = out.find("<svg"), box = out.find("viewBox", head);
  if (head != std::string::npos && box != std::string::npos)
    out.replace(head, box - head,
                fmt::format("<svg role=\"img\" aria-label=\"{}\" width=\"100%\" ", escaped(page.label)));
  return out;
}

std::string terminal(const std::string& picture_name, int width, int height) {
  const bool svg = picture_name.ends_with(".svg");
  return fmt::format(
      "set encoding utf8\nset terminal {} size {},{} font 'DejaVu Sans,{}' noenhanced background 'white'\n"
      "set output {}\n",
      svg ? "svg" : "pngcairo", width, height, font_size(picture_name, 11), single_quoted(picture_name));
}

int font_size(const std::string& picture_name, int points) {
  return picture_name.ends_with(".svg") ? (points * 96 + 36) / 80 : points;
}

std::string single_quoted(const std::string& text) {
  std::string result = "'";
  for (char c : text) {
    if (c == '\'') result += '\'';
    result += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
  }
  return result + '\'';
}

std::string shortened(const std::string& text, std::size_t most) {
  if (text.size() <= most) return text;
  std::size_t end = most;
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0) == 0x80) --end;
  return text.substr(0, end) + "…";
}

std::vector<std::string> wrapped(const std::string& text, std::size_t most) {
  std::vector<std::string> lines(1);
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find(' ', at), text.size());
    const std::string word = text.substr(at, end - at);
    if (!lines.back().empty() && lines.back().size() + 1 + word.size() > most) lines.emplace_back();
    lines.back() += (lines.back().empty() ? "" : " ") + word;
    at = end + 1;
  }
  return lines;
}

double nice_step(double least) {
  const double decade = std::pow(10.0, std::floor(std::log10(least)));
  for (double mantissa : {1.0, 2.0, 2.5, 5.0})
    if (mantissa * decade >= least) return mantissa * decade;
  return 10.0 * decade;
}

int decimals_of(double step) {
  for (int decimals = 0; decimals < 12; ++decimals) {
    const double scaled = step * std::pow(10.0, decimals);
    if (std::abs(scaled - std::round(scaled)) < 1e-6 * scaled) return decimals;
  }
  return 12;
}

std::string with_error(double value, double sigma) {
  // One digit of the error, two when the first is a 1.
  if (!(sigma > 0.0)) return fmt::format("{:.3g}", value);
  const int decimals = std::clamp(-static_cast<int>(std::floor(std::log10(0.5 * sigma))), 0, 6);
  return fmt::format("{:.{}f} ± {:.{}f}", value, decimals, sigma, decimals);
}

std::pair<double, double> padded(double low, double high) {
  const double span = high - low;
  const double pad = span > 0.0 ? 0.045 * span : (low != 0.0 ? 0.1 * std::abs(low) : 1.0);
  return {low - pad, high + pad};
}

}  // namespace drumsweep
