/// drumsweep report
#include "sweep/report/report.h"

#include <fmt/format.h>

#include <memory>
#include <string>

#include "cli/arguments.h"
#include "cli/commands.h"
#include "core/config/schema.h"
#include "core/io/durable_file.h"
#include "sweep/stop.h"

namespace drumsweep {
namespace {

struct ReportArguments {
  std::string folder, file;
  ReportOptions report;
};

int report(const ReportArguments& options) {
  install_stop_signals();
  if (!options.file.ends_with(".html")) throw InputError(options.file + ": unknown ending, accepted: .html");
  need_place_for(options.file);
  const Report made = make_report(options.folder, options.report);
  // Ctrl-C ends gnuplot and POV-Ray too, so the page has gaps.
  if (stop_requested()) {
    fmt::print(stderr, "drumsweep: stopped by {}; nothing was written\n", stop_signal());
    return exit_stopped;
  }
  write_durably(options.file, made.html);
  for (const std::string& note : made.notes) fmt::print(stderr, "drumsweep: {}\n", note);
  fmt::print("{}\n", options.file);
  return exit_done;
}

}  // namespace

void add_report(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<ReportArguments>();
  CLI::App* command =
      app.add_subcommand("report", "One self-contained page about a sweep: answer, evidence, provenance.");
  command->add_option("OUT", options->folder, "output folder of a run; may be going on, and is not changed")
      ->required();
  command->add_option("-o,--output", options->file, "FILE.html")->required();
  command->add_flag("!--no-picture", options->report.picture, "do not render the drum (which needs POV-Ray)");
  command->footer(
      "Example:\n  drumsweep report out -o report.html\n"
      "The page needs no network, prints on A4, and says at its top when the sweep is not finished. Lengths in it "
      "have\n"
      "their units beside them; f is in millimetres.");
  command->callback([options, &exit_code] { exit_code = report(*options); });
}

}  // namespace drumsweep
