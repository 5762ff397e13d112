/// drumsweep verify
#include "postproc/verify/verify.h"

#include <fmt/format.h>

#include <algorithm>
#include <future>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "cli/commands.h"
#include "cli/json.h"
#include "core/config/schema.h"
#include "core/io/durable_file.h"
#include "sweep/progress.h"
#include "sweep/stop.h"
#include "sweep/store/store.h"

namespace drumsweep {
namespace {

struct VerifyArguments {
  std::string folder;
  std::vector<std::string> only;
  bool full = false, json = false;
};

int verify(const VerifyArguments& options) {
  install_stop_signals();
  make_folder(options.folder);
  Reporter reporter;
  std::vector<const VerifyGroup*> groups;
  for (const VerifyGroup& g : verify_groups())
    if (options.only.empty() || std::find(options.only.begin(), options.only.end(), g.name) != options.only.end())
      groups.push_back(&g);

  // Groups are independent: as many at a time as there are cores; the table keeps their order.
  const VerifyOptions how{options.full, options.folder, [] { return !stop_requested(); }};
  std::vector<std::vector<VerifyCase>> results(groups.size());
  std::vector<std::string> failures(groups.size());
  std::mutex mutex;
  std::size_t next = 0;
  const auto work = [&] {
    for (;;) {
      std::size_t mine = 0;
      {
        const std::lock_guard lock(mutex);
        if (next == groups.size() || stop_requested()) return;
        mine = next++;
        reporter.info(fmt::format("{}: {}", groups[mine]->name, groups[mine]->about));
      }
      try {
        results[mine] = groups[mine]->run(how);
      } catch (const std::exception& error) {
        failures[mine] = error.what();
      }
    }
  };
  std::vector<std::thread> threads;
  for (unsigned t = 0; t < std::max(1u, std::thread::hardware_concurrency()); ++t) threads.emplace_back(work);
  for (std::thread& t : threads) t.join();
  if (stop_requested()) {
    fmt::print(stderr, "drumsweep: stopped by {}; no table was written\n", stop_signal());
    return exit_stopped;
  }
  for (std::size_t i = 0; i < groups.size(); ++i)
    if (!failures[i].empty()) throw std::runtime_error(std::string(groups[i]->name) + ": " + failures[i]);

  std::vector<VerifyCase> all;
  std::vector<std::string> list;
  for (const auto& cases : results) all.insert(all.end(), cases.begin(), cases.end());
  const std::string table = options.folder + "/verify.csv";
  write_durably(table, verify_csv(all));
  const auto failed = std::count_if(all.begin(), all.end(), [](const VerifyCase& c) { return !c.pass(); });
  if (options.json) {
    for (const VerifyCase& c : all)
      list.push_back(JsonObject()
                         .text("name", c.name)
                         .text("source", c.source)
                         .text("expected", c.expected)
                         .number("low", c.low)
                         .number("high", c.high)
                         .number("got", c.got)
                         .flag("pass", c.pass())
                         .text("note", c.note)
                         .str());
    fmt::print("{}\n", JsonObject().raw("cases", json_list(list)).count("failed", failed).str());
  } else {
    for (std::size_t i = 0; i < groups.size(); ++i) {
      fmt::print("\n{}: {}\n", groups[i]->name, groups[i]->about);
      for (const VerifyCase& c : results[i])
        fmt::print("  {}  {:<52} {:>10.5g} in [{:.5g}, {:.5g}]  ({}){}\n", c.pass() ? "pass" : "FAIL", c.name, c.got,
                   c.low, c.high, c.source, c.note.empty() ? "" : "\n        " + c.note);
    }
    fmt::print("\n{} of {} cases pass; table: {}\n", all.size() - static_cast<std::size_t>(failed), all.size(), table);
  }
  return failed == 0 ? exit_done : exit_some_failed;
}

}  // namespace

void add_verify(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<VerifyArguments>();
  CLI::App* command = app.add_subcommand(
      "verify",
      "Prove the engine: closed forms, measured data and an independent method, as a table of pass and FAIL.");
  command->add_option("-o,--output", options->folder, "folder for the table and the plots")->required();
  command->add_flag("--full", options->full, "larger and finer cases too: hours instead of minutes");
  std::vector<std::string> names;
  for (const VerifyGroup& g : verify_groups()) names.emplace_back(g.name);
  command->add_option("--only", options->only, "only these groups: " + fmt::format("{}", fmt::join(names, ", ")))
      ->delimiter(',')
      ->check(CLI::IsMember(names));
  command->add_flag("--json", options->json, "one JSON object on standard output");
  command->footer(
      "Example:\n  drumsweep verify -o proof\n"
      "Writes verify.csv and plots. Exit code 4 when a case fails.");
  command->callback([options, &exit_code] { exit_code = verify(*options); });
}

}  // namespace drumsweep
