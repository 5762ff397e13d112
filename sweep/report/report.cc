#include "sweep/report/report.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <ctime>

#include "postproc/report/html.h"
#include "sweep/report/sections.h"

namespace drumsweep {

Report make_report(const std::string& folder, const ReportOptions& options) {
  ReportData data = gather_report(folder);
  Page page;
  page.title = data.study.name + " – drumsweep report";
  page.header = header_html(data);
  const auto add = [&](const char* id, const char* title, std::string body) {
    if (!body.empty()) page.sections.push_back({id, title, std::move(body)});
  };
  add("optimum", "The optimum", answer_html(data));
  add("contours", "f over the design variables", contours_html(data));
  add("samples", "The paper’s sample designs", samples_html(data));
  add("asked", "What was asked", asked_html(data));
  add("drum", "The drum, and that it is steady", drum_html(data, options.picture));
  add("search", "The path of the search", search_html(data));
  add("noise", "Noise", noise_html(data));
  add("trouble", "Untrusted and failed designs", trouble_html(data));
  add("solver", "How well the contacts were solved", solver_html(data));
  add("cost", "Cost", cost_html(data));
  add("designs", "All designs", designs_html(data));
  add("provenance", "Where these numbers come from", provenance_html(data));
  page.footer = fmt::format(
      "Written by drumsweep {} on {:%Y-%m-%d %H:%M} UTC, from what was stored then. Lengths of <i>f</i> in "
      "millimetres; errors are one standard error unless they say otherwise.",
      DRUMSWEEP_VERSION, fmt::gmtime(std::time(nullptr)));
  return {html_of(page), data.notes};
}

}  // namespace drumsweep
