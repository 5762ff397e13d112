#include "sweep/doctor/rank_facts.h"

#include <fmt/format.h>
#include <sched.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <map>
#include <set>
#include <sstream>

#include "core/simd/targets.h"

namespace drumsweep {
namespace {

using Level = Finding::Level;

/// Below this a large drum does not fit: 1 kB a ball, 100,000 balls.
constexpr std::int64_t small_memory_bytes = 100'000'000;

std::vector<int> allowed_cpus() {
  // Larger than cpu_set_t, which ends at 1024 CPUs.
  constexpr std::size_t most = 16384;
  cpu_set_t* set = CPU_ALLOC(most);
  std::vector<int> cpus;
  if (::sched_getaffinity(0, CPU_ALLOC_SIZE(most), set) == 0)
    for (std::size_t i = 0; i < most; ++i)
      if (CPU_ISSET_S(i, CPU_ALLOC_SIZE(most), set)) cpus.push_back(static_cast<int>(i));
  CPU_FREE(set);
  return cpus;
}

std::int64_t available_memory() {
  std::int64_t bytes = std::numeric_limits<std::int64_t>::max();
  std::ifstream meminfo("/proc/meminfo");
  for (std::string line; std::getline(meminfo, line);)
    if (line.rfind("MemAvailable:", 0) == 0) bytes = 1024 * std::atoll(line.c_str() + 13);
  // In MB; 0 grants the whole node.
  if (const char* granted = std::getenv("SLURM_MEM_PER_NODE"); granted != nullptr && std::atoll(granted) > 0)
    bytes = std::min(bytes, static_cast<std::int64_t>(std::atoll(granted)) << 20);
  return bytes;
}

std::set<std::string> distinct(const std::vector<RankFacts>& facts, std::string RankFacts::*what) {
  std::set<std::string> values;
  for (const RankFacts& f : facts) values.insert(f.*what);
  return values;
}

struct Host {
  std::vector<const RankFacts*> ranks;
  std::set<int> cpus;  ///< of all its ranks together
};

std::map<std::string, Host> by_host(const std::vector<RankFacts>& facts) {
  std::map<std::string, Host> hosts;
  for (const RankFacts& f : facts) {
    hosts[f.host].ranks.push_back(&f);
    hosts[f.host].cpus.insert(f.cpus.begin(), f.cpus.end());
  }
  return hosts;
}

Finding judge_hosts(const std::map<std::string, Host>& hosts, std::size_t num_ranks) {
  // A cluster has many hosts with the same number of ranks.
  std::map<std::size_t, std::vector<std::string>> names;
  for (const auto& [name, host] : hosts) names[host.ranks.size()].push_back(name);
  std::string list;
  for (const auto& [num, which] : names)
    list += fmt::format("{}{} on {}{}", list.empty() ? "" : "; ", num, which.front(),
                        which.size() == 1   ? ""
                        : which.size() == 2 ? " and on " + which.back()
                                            : fmt::format(" and on {} others", which.size() - 1));
  return {Level::ok, "ranks",
          num_ranks == 1 ? fmt::format("one, on {}; `mpirun -n 2 drumsweep doctor` looks at how several fare",
                                       hosts.begin()->first)
                         : fmt::format("{} see each other: {}", num_ranks, list),
          ""};
}

Finding judge_binding(const std::map<std::string, Host>& hosts, int threads) {
  for (const auto& [name, host] : hosts) {
    const RankFacts& first = *host.ranks.front();
    const std::size_t wanted = host.ranks.size() * static_cast<std::size_t>(threads);
    const auto online = static_cast<std::size_t>(first.online_cpus);
    const bool few_each = std::any_of(host.ranks.begin(), host.ranks.end(), [&](const RankFacts* r) {
      return r->cpus.size() < static_cast<std::size_t>(threads);
    });
    const std::string found =
        fmt::format("{}: {} rank{} of {} thread{} may run on {} of {} CPUs ({})", name, host.ranks.size(),
                    host.ranks.size() == 1 ? "" : "s", threads, threads == 1 ? "" : "s", host.cpus.size(), online,
                    cpu_ranges({host.cpus.begin(), host.cpus.end()}));
    if (wanted > host.cpus.size() && host.cpus.size() < online)
      return {Level::warning, "binding", found,
              "they wait for each other while other CPUs may be idle: mpirun --bind-to none, srun --cpu-bind=none, or "
              "ask for more CPUs (--ntasks-per-node, --cpus-per-task)"};
    if (wanted > host.cpus.size())
      return {Level::warning, "binding", found,
              "more threads than CPUs wait for each other: start fewer ranks (one a core), or fewer threads"};
    if (few_each)
      return {Level::warning, "binding",
              fmt::format("{}: a rank may run on fewer CPUs than its {} threads need", name, threads),
              "mpirun --bind-to none, srun --cpu-bind=none"};
    // Each may run on few CPUs, enough in all, and yet two on the same one.
    std::map<int, int> alone_on;
    for (const RankFacts* r : host.ranks)
      if (r->cpus.size() == 1 && ++alone_on[r->cpus.front()] > 1)
        return {Level::warning, "binding", fmt::format("{}: several ranks are bound to CPU {}", name, r->cpus.front()),
                "mpirun --bind-to none, srun --cpu-bind=none"};
  }
  const Host& host = hosts.begin()->second;
  return {Level::ok, "binding",
          fmt::format("{} CPU{} for {} rank{} of {} thread{} on {}, of {} in the machine", host.cpus.size(),
                      host.cpus.size() == 1 ? "" : "s", host.ranks.size(), host.ranks.size() == 1 ? "" : "s", threads,
                      threads == 1 ? "" : "s", hosts.begin()->first, host.ranks.front()->online_cpus),
          ""};
}

Finding judge_memory(const std::map<std::string, Host>& hosts) {
  std::int64_t least = std::numeric_limits<std::int64_t>::max();
  std::string where;
  for (const auto& [name, host] : hosts)
    for (const RankFacts* r : host.ranks)
      if (const auto each = r->available_bytes / static_cast<std::int64_t>(host.ranks.size()); each < least) {
        least = each;
        where = name;
      }
  const bool small = least < small_memory_bytes;
  return {small ? Level::warning : Level::ok, "memory",
          fmt::format("{:.2f} GB free for each rank on {}", 1e-9 * static_cast<double>(least), where),
          small
              ? "`drumsweep check STUDY` says how much a rank needs; start fewer ranks a node, or ask for more (--mem)"
              : ""};
}

}  // namespace

RankFacts own_facts(const std::string& host) {
  return {host,          allowed_cpus(),   static_cast<int>(::sysconf(_SC_NPROCESSORS_ONLN)), available_memory(),
          simd_target(), DRUMSWEEP_VERSION};
}

std::string pack_facts(const RankFacts& f) {
  return fmt::format("{}\n{}\n{}\n{}\n{}\n{}\n", f.host, fmt::join(f.cpus, " "), f.online_cpus, f.available_bytes,
                     f.simd, f.version);
}

RankFacts unpack_facts(const std::string& text) {
  std::istringstream lines(text);
  const auto next = [&] {
    std::string line;
    std::getline(lines, line);
    return line;
  };
  RankFacts f;
  f.host = next();
  std::istringstream cpus(next());
  for (int cpu = 0; cpus >> cpu;) f.cpus.push_back(cpu);
  f.online_cpus = std::stoi(next());
  f.available_bytes = std::stoll(next());
  f.simd = next();
  f.version = next();
  return f;
}

std::string cpu_ranges(const std::vector<int>& cpus) {
  std::string out;
  for (std::size_t i = 0, end = 0; i < cpus.size(); i = end) {
    end = i + 1;
    while (end < cpus.size() && cpus[end] == cpus[end - 1] + 1) ++end;
    out += fmt::format("{}{}", out.empty() ? "" : ",", cpus[i]);
    if (end > i + 1) out += fmt::format("-{}", cpus[end - 1]);
  }
  return out;
}

std::vector<Finding> judge_ranks(const std::vector<RankFacts>& facts, int threads) {
  const auto hosts = by_host(facts);
  std::vector<Finding> findings{judge_hosts(hosts, facts.size())};
  if (const auto versions = distinct(facts, &RankFacts::version); versions.size() > 1)
    findings.push_back({Level::problem, "versions", fmt::format("the ranks run {}", fmt::join(versions, " and ")),
                        "all nodes need the same build: put it on the file system that they share"});
  findings.push_back(judge_binding(hosts, threads));
  findings.push_back(
      {Level::ok, "SIMD",
       fmt::format("{} (results are the same bits with any)", fmt::join(distinct(facts, &RankFacts::simd), "; ")), ""});
  findings.push_back(judge_memory(hosts));
  return findings;
}

}  // namespace drumsweep
