#include "sweep/job_script.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <map>
#include <regex>

#include "core/config/schema.h"

namespace drumsweep {
namespace {

bool is_control(char c) { return static_cast<unsigned char>(c) < 32 || c == 127; }

/// One word for the shell, whatever is in it.
std::string shell_quoted(const std::string& text) {
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

/// One value in an #SBATCH line, which sbatch splits itself; % begins a pattern there.
std::string sbatch_quoted(const std::string& path) {
  std::string out = "\"";
  for (const char c : path) {
    if (c == '"' || c == '\\') out += '\\';
    out += c == '%' ? std::string("%%") : std::string(1, c);
  }
  return out + "\"";
}

/// Partitions, accounts and modules are plain words; anything else would become part of the script.
const std::string& plain_word(const std::string& option, const std::string& value) {
  static const std::regex pattern("[A-Za-z0-9._,:/+@=-]+");
  if (!std::regex_match(value, pattern))
    throw InputError(fmt::format("--{} {}: accepted are letters, digits and . _ , : / + @ = -", option, value));
  return value;
}

void expect_one_line(const std::string& text) {
  if (std::any_of(text.begin(), text.end(), is_control))
    throw InputError(fmt::format("{}: control characters cannot stand in a job script", text));
}

std::string job_name(const std::string& title) {
  std::string name = title.empty() ? "drumsweep" : title;
  for (char& c : name)
    if (std::isalnum(static_cast<unsigned char>(c)) == 0 && c != '-' && c != '_' && c != '.') c = '_';
  return name;
}

std::string launcher(const JobOptions& o) {
  if (o.launcher == "srun")
    return fmt::format(
        "srun --mpi=pmix --ntasks=$((SLURM_JOB_NUM_NODES * ranks_per_node)) --ntasks-per-node=\"$ranks_per_node\" "
        "--cpus-per-task={} --cpu-bind=ldoms --kill-on-bad-exit=1",
        o.threads);
  // Slots and bindings are counted differently from site to site (hyperthreads, --exclusive); the number of ranks says
  // all that is needed.
  return "mpirun --map-by \"ppr:$ranks_per_node:node\" --oversubscribe --bind-to numa:overload-allowed";
}

}  // namespace

std::int64_t slurm_time_s(const std::string& text) {
  // Groups: days - hours : minutes : seconds; hours : minutes : seconds; minutes : seconds.
  static const std::regex with_days("(\\d{1,9})-(\\d{1,9})(?::(\\d{1,9})(?::(\\d{1,9}))?)?");
  static const std::regex with_hours("(\\d{1,9}):(\\d{1,9}):(\\d{1,9})");
  static const std::regex with_minutes("(\\d{1,9})(?::(\\d{1,9}))?");
  std::smatch part;
  const auto value = [&](std::size_t i) { return part[i].matched ? std::stoll(part[i].str()) : 0LL; };
  std::int64_t seconds = 0;
  if (std::regex_match(text, part, with_days))
    seconds = value(1) * 86400 + value(2) * 3600 + value(3) * 60 + value(4);
  else if (std::regex_match(text, part, with_hours))
    seconds = value(1) * 3600 + value(2) * 60 + value(3);
  else if (std::regex_match(text, part, with_minutes))
    seconds = value(1) * 60 + value(2);
  if (seconds < 1 || seconds > 366 * 86400LL)
    throw InputError(
        fmt::format("--time {}: accepted are 1 second to 366 days, written as Slurm does: minutes, "
                    "minutes:seconds, hours:minutes:seconds, days-hours, days-hours:minutes or "
                    "days-hours:minutes:seconds",
                    text));
  return seconds;
}

std::string job_log(const JobOptions& options) { return options.output + ".log"; }

std::string job_script(const JobOptions& o) {
  const std::int64_t limit_s = slurm_time_s(o.time);
  if (o.signal_before_s >= limit_s)
    throw InputError(fmt::format("--signal-before {} with a time limit of {} s: accepted is 10 to {}",
                                 o.signal_before_s, limit_s, limit_s - 1));
  for (const std::string& path : {o.program, o.study_path, o.output}) expect_one_line(path);
  std::string changes;
  for (const std::string& change : o.changes) {
    expect_one_line(change);
    changes += " --set " + shell_quoted(change);
  }

  std::string title = o.title, site, modules;
  std::replace_if(title.begin(), title.end(), is_control, ' ');
  if (!o.partition.empty()) site += fmt::format("#SBATCH --partition={}\n", plain_word("partition", o.partition));
  if (!o.account.empty()) site += fmt::format("#SBATCH --account={}\n", plain_word("account", o.account));
  for (const std::string& module : o.modules) modules += fmt::format("module load {}\n", plain_word("module", module));
  std::string tasks = o.tasks_per_node > 0 ? fmt::format("#SBATCH --ntasks-per-node={}", o.tasks_per_node)
                                           : std::string("# Whole nodes.\n#SBATCH --exclusive");
  if (o.tasks_per_node > 0 && o.threads > 1) tasks += fmt::format("\n#SBATCH --cpus-per-task={}", o.threads);

  const std::map<std::string, std::string> values = {
      {"shell_options", o.modules.empty() ? "" : " -l"},  // a login shell knows `module`
      {"title", title},
      {"job_name", job_name(o.title)},
      {"nodes", std::to_string(o.nodes)},
      {"tasks", tasks},
      {"time", o.time},
      {"site_options", site},
      {"log", sbatch_quoted(job_log(o))},
      {"signal_before_s", std::to_string(o.signal_before_s)},
      {"modules", modules},
      {"program", shell_quoted(o.program)},
      {"study", shell_quoted(o.study_path)},
      {"changes", changes},
      {"out", shell_quoted(o.output)},
      {"max_requeues", std::to_string(o.max_requeues)},
      {"ranks_per_node", o.tasks_per_node > 0 ? std::to_string(o.tasks_per_node)
                         : o.threads == 1
                             ? std::string("$SLURM_CPUS_ON_NODE")
                             : fmt::format("$((SLURM_CPUS_ON_NODE < {0} ? 1 : SLURM_CPUS_ON_NODE / {0}))", o.threads)},
      {"launcher", launcher(o)},
      {"threads", std::to_string(o.threads)},
  };

  // One pass, so that an @ in a value stays what it is.
  static const std::regex place("@([a-z_]+)@");
  const std::string text = job_templates[0].text;
  std::string out;
  auto rest = text.cbegin();
  for (std::smatch match; std::regex_search(rest, text.cend(), match, place); rest = match[0].second)
    out.append(rest, match[0].first).append(values.at(match[1].str()));
  return out.append(rest, text.cend());
}

}  // namespace drumsweep
