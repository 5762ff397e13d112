/// drumsweep why
#include "sweep/why.h"

#include <fmt/format.h>

#include <memory>
#include <string>
#include <vector>

#include "cli/commands.h"
#include "cli/json.h"
#include "core/config/schema.h"

namespace drumsweep {
namespace {

struct WhyArguments {
  std::string folder, id;
  std::vector<double> at;
  bool json = false;
};

void print_json(const DesignStory& story) {
  JsonObject values, all;
  for (std::size_t i = 0; i < story.columns.size(); ++i) values.number(story.columns[i], story.design.row[i]);
  std::vector<std::string> attempts, files;
  for (const DesignStory::Attempt& a : story.attempts)
    attempts.push_back(JsonObject()
                           .count("attempt", a.number)
                           .text("host", a.host)
                           .count("rank", a.rank)
                           .text("begin", a.begin_utc)
                           .text("end", a.end_utc)
                           .text("event", a.event)
                           .number("wall_s", a.wall_s)
                           .number("cpu_s", a.cpu_s)
                           .str());
  for (const std::string& file : story.files) files.push_back(json_text(file));
  all.text("design_id", story.design.id).text("stage", story.design.stage).raw("values", values.str());
  all.text("state", story.state).text("reason", story.reason);
  all.raw("f_m", story.row ? json_number(story.row->f_m) : "null");
  all.raw("sigma_f_m", story.row ? json_number(story.row->sigma_f_m) : "null");
  all.raw("attempts", json_list(attempts)).raw("files", json_list(files)).text("retry", story.retry);
  fmt::print("{}\n", all.str());
}

void print_text(const DesignStory& story) {
  fmt::print("design     {} of stage {}: ", story.design.id, story.design.stage);
  for (std::size_t i = 0; i < story.columns.size(); ++i)
    fmt::print("{}{} = {}", i == 0 ? "" : ", ", story.columns[i], story.design.row[i]);
  fmt::print("\nstate      {}{}\n", story.state, story.reason.empty() ? "" : ": " + story.reason);
  if (story.row && story.row->state != "failed")
    fmt::print("result     f = {:.4g} +- {:.2g} m, {} balls landed, mean residual {:.2g} m/s\n", story.row->f_m,
               story.row->sigma_f_m, story.row->landed, story.row->residual);
  for (const DesignStory::Attempt& a : story.attempts)
    fmt::print("attempt {}  {} rank {}{}: {}{}\n", a.number, a.begin_utc, a.rank, a.host.empty() ? "" : " on " + a.host,
               a.event, a.wall_s > 0 ? fmt::format(" after {:.1f} s ({:.1f} s CPU)", a.wall_s, a.cpu_s) : "");
  for (const std::string& file : story.files) fmt::print("file       {}\n", file);
  if (!story.retry.empty()) fmt::print("to do      {}\n", story.retry);
}

void why(const WhyArguments& options) {
  if (options.id.empty() == options.at.empty())
    throw InputError("why: needs an ID or --at with values, and not both; `drumsweep why --help` has examples");
  const DesignStory story = story_of(options.folder, options.id, options.at);
  if (options.json)
    print_json(story);
  else
    print_text(story);
}

}  // namespace

void add_why(CLI::App& app, int&) {
  auto options = std::make_shared<WhyArguments>();
  CLI::App* command = app.add_subcommand("why", "What became of one design, and why.");
  command->add_option("OUT", options->folder, "output folder of a run")->required();
  command->add_option("ID", options->id, "design id, as in results.csv, or an unambiguous beginning of it");
  command
      ->add_option(
          "--at", options->at,
          "the design's values instead of its id, in the order of the table's columns; replicate and turns may "
          "be left out")
      ->delimiter(',');
  command->add_flag("--json", options->json, "one JSON object on standard output");
  command->footer(
      "Examples:\n  drumsweep why out 3fa9\n  drumsweep why out --at 0.2,0.044 --json\n"
      "State with its reason, every attempt with host, rank and time, the files, and how to try again.\n"
      "Values of --at are in the units of the column names.");
  command->callback([options] { why(*options); });
}

}  // namespace drumsweep
