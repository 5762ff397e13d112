#include "diagnosis/campaign/runs.h"

#include <fmt/format.h>

#include <chrono>
#include <filesystem>
#include <sstream>

#include "core/config/toml_reader.h"
#include "core/io/durable_file.h"
#include "core/io/hdf5_image.h"
#include "core/io/snapshot.h"
#include "diagnosis/model/draws.h"
#include "diagnosis/model/fit.h"
#include "sweep/fit/box.h"
#include "sweep/stop.h"
#include "sweep/store/output_lock.h"
#include "sweep/store/store.h"

namespace drumsweep {
namespace {

namespace fs = std::filesystem;
using Index = Eigen::Index;

constexpr int run_layout = 1;

/// Seeds stay below 2^53, as everywhere.
std::int64_t mixed(std::int64_t seed, std::uint64_t number) {
  return replicate_seed(seed, static_cast<double>(number + 1));
}

/// All numbers of a box in one line.
std::string to_line(const LocalCentre& box) {
  std::string out = fmt::format("{}", fmt::join(box.effects, ","));
  for (const Eigen::VectorXd* numbers : {&box.x, &box.half_width})
    for (const double number : *numbers) out += fmt::format(" {:.4f}", number);
  return out;
}

/// FNV-1a (Fowler, Noll, Vo) with 64 bits.
std::uint64_t digest(const std::string& text) {
  std::uint64_t hash = 0xcbf29ce484222325u;
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3u;
  return hash;
}

std::string header() {
  return fmt::format("# drumsweep diagnosis folder, layout {}, program {}\n", run_layout, DRUMSWEEP_VERSION);
}

}  // namespace

DesignPoint design_point(const Campaign& c, std::size_t run, std::size_t num_design_runs) {
  const auto num_parameters = static_cast<Index>(c.parameters.size()),
             num_effects = static_cast<Index>(c.candidates.size());
  DesignPoint out;
  out.u = Eigen::VectorXd::Zero(num_parameters);
  out.p = Eigen::VectorXd::Zero(num_effects);
  if (run >= num_design_runs) {
    const std::size_t pair = (run - num_design_runs) / 2;
    out.finer = (run - num_design_runs) % 2 == 1;
    out.seed = mixed(c.seed, 1'000'000'000 + pair);
    return out;
  }
  out.seed = mixed(c.seed, run);
  const std::vector<double> at = low_discrepancy(c.parameters.size() + 2, c.seed, run);
  for (Index j = 0; j < num_parameters; ++j) out.u[j] = design_reach * (2 * at[static_cast<std::size_t>(j)] - 1);
  const double first = at[c.parameters.size()], second = at[c.parameters.size() + 1];
  // In blocks of twenty runs 3 have no effect, 9 one and 8 two.
  const std::size_t in_block = run % 20, block = run / 20;
  const auto strength = [&](Index k, double t) {
    const CandidateEffect& e = c.candidates[static_cast<std::size_t>(k)].effect;
    out.p[k] = e.inner(e.low) + (e.inner(e.high) - e.inner(e.low)) * t;
  };
  const std::size_t number = in_block % 20 < 3 ? 0 : in_block < 12 ? 1 : 2;
  if (number == 1)
    strength(static_cast<Index>((block * 9 + in_block - 3) % static_cast<std::size_t>(num_effects)), first);
  if (number == 2) {
    if (num_effects == 1) {
      strength(0, first);
      return out;
    }
    // Pairs in turn.
    const auto num_pairs = static_cast<std::size_t>(num_effects * (num_effects - 1) / 2);
    std::size_t left = (block * 8 + in_block - 12) % num_pairs;
    Index a = 0;
    for (; left >= static_cast<std::size_t>(num_effects - 1 - a); ++a)
      left -= static_cast<std::size_t>(num_effects - 1 - a);
    strength(a, first);
    strength(a + 1 + static_cast<Index>(left), second);
  }
  return out;
}

std::size_t num_local_runs(const Campaign& c, const LocalCentre& box) {
  const Index wanted = c.second_wave >= 0 ? static_cast<Index>(c.second_wave) : 10 * (1 + box.x.size());
  return static_cast<std::size_t>(std::max(wanted, fewest_local_runs(box)));
}

DesignPoint local_point(const Campaign& c, const LocalCentre& box, std::size_t run) {
  // Box and campaign decide the random numbers, so that no box shares any with the design or another box.
  const std::int64_t seed = mixed(c.seed, 2'000'000'000 + digest(to_line(box)) % 1'000'000'000);
  const std::vector<double> at = low_discrepancy(static_cast<std::size_t>(box.x.size()), seed, run);
  const auto num_parameters = static_cast<Index>(c.parameters.size());
  DesignPoint out;
  out.u = Eigen::VectorXd::Zero(num_parameters);
  out.p = Eigen::VectorXd::Zero(static_cast<Index>(c.candidates.size()));
  out.seed = mixed(seed, run);
  for (Index i = 0; i < box.x.size(); ++i) {
    const double x = box.x[i] + box.half_width[i] * (2 * at[static_cast<std::size_t>(i)] - 1);
    (i < num_parameters ? out.u[i] : out.p[box.effects[static_cast<std::size_t>(i - num_parameters)]]) = x;
  }
  return out;
}

std::optional<RunResult> simulate_run(const Campaign& c, const DesignPoint& point, int threads, const GoOn& go_on) {
  RunResult out;
  for (std::size_t i = 0; i < c.conditions.size(); ++i) {
    const Condition& condition = c.conditions[i];
    out.observables.emplace_back();
    out.failure.emplace_back();
    try {
      ConditionResult r = condition.simulate(mixed(point.seed, i), c.changes(condition, point.u, point.p),
                                             {point.finer}, threads, go_on);
      if (r.stopped) return std::nullopt;
      out.observables.back() = std::move(r.observables);
      out.cpu_s += r.cpu_s;
    } catch (const std::exception& error) {
      out.failure.back() = error.what();
    }
  }
  return out;
}

std::string pack_run(const Campaign& c, const RunResult& r) {
  Hdf5Writer out;
  out.attribute("program_version", std::string(DRUMSWEEP_VERSION));
  out.attribute("cpu_s", r.cpu_s);
  for (std::size_t i = 0; i < c.conditions.size(); ++i) {
    std::vector<std::string> names, units, position_units;
    std::vector<double> numbers;
    for (const Observable& o : r.observables[i]) {
      names.push_back(o.name);
      units.push_back(o.unit);
      position_units.push_back(o.position_unit);
      numbers.insert(numbers.end(), {o.position, o.value, o.sigma});
    }
    const std::string group = fmt::format("conditions/{}", i);
    out.attribute("id", c.conditions[i].id, group);
    out.texts(group + "/failure", {r.failure[i]}, "why this condition could not be simulated; empty: it was");
    if (names.empty()) continue;
    out.texts(group + "/names", names, "quantities");
    out.texts(group + "/units", units, "of value and standard error");
    out.texts(group + "/position_units", position_units, "of the position");
    out.dataset(group + "/numbers", numbers, 3, "in units", "position, value, standard error");
  }
  return out.seal("diagnosis_run", run_layout);
}

RunResult unpack_run(const std::string& bytes, const Campaign& c, const std::string& source) {
  const Hdf5Reader in(bytes, "diagnosis_run", run_layout, source);
  RunResult out;
  out.cpu_s = in.real("cpu_s");
  for (std::size_t i = 0; i < c.conditions.size(); ++i) {
    const std::string group = fmt::format("conditions/{}", i);
    out.failure.push_back(in.texts(group + "/failure").at(0));
    out.observables.emplace_back();
    if (!out.failure.back().empty()) continue;
    const std::vector<std::string> names = in.texts(group + "/names"), units = in.texts(group + "/units"),
                                   position_units = in.texts(group + "/position_units");
    const std::vector<double> numbers = in.doubles(group + "/numbers");
    for (std::size_t k = 0; k < names.size(); ++k)
      out.observables.back().push_back(
          {names[k], numbers[3 * k], numbers[3 * k + 1], numbers[3 * k + 2], units[k], position_units[k]});
  }
  return out;
}

std::string CampaignStore::run_path(std::size_t run) const { return fmt::format("{}/runs/{:06}.h5", folder, run); }
std::string CampaignStore::local_path(const LocalCentre& box, std::size_t run) const {
  return fmt::format("{}/second_wave/{:016x}/{:06}.h5", folder, digest(to_line(box)), run);
}
bool CampaignStore::has(std::size_t run) const { return fs::exists(run_path(run)); }

void CampaignStore::check(const Campaign& campaign) const {
  const std::string path = folder + "/campaign.txt";
  if (!fs::exists(folder)) return;
  if (!fs::exists(path)) {
    for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
      const std::string name = entry.path().filename().string();
      if (name != "lock" && name != "run.log" && entry.path().extension() != ".tmp")
        throw MismatchError(fmt::format(
            "{}: is not empty and not the output folder of a diagnosis; nothing was changed, choose another folder",
            folder));
    }
    return;
  }
  const std::string stored = read_whole_file(path), given = header() + campaign.fingerprint();
  if (stored == given) return;
  // The first line that differs says most.
  std::size_t at = 0, line = 0;
  while (at < std::min(stored.size(), given.size()) && stored[at] == given[at]) {
    if (stored[at] == '\n') line = at + 1;
    ++at;
  }
  const auto line_of = [&](const std::string& text) { return text.substr(line, text.find('\n', line) - line); };
  throw MismatchError(
      fmt::format("{}: was made by another campaign or program version; nothing was changed. Stored: \"{}\"; given: "
                  "\"{}\". Measured values, runs "
                  "and bootstraps may change, what is simulated may not",
                  folder, line_of(stored), line_of(given)));
}

void CampaignStore::open(const Campaign& campaign) const {
  check(campaign);
  make_folder(folder + "/runs");
  if (!fs::exists(folder + "/campaign.txt")) write_durably(folder + "/campaign.txt", header() + campaign.fingerprint());
}

namespace {

/// Runs with their numbers in the store: design runs count from 0, numerics from 900000, so that a longer design keeps all.
constexpr std::size_t numerics_begin = 900'000;

std::vector<std::size_t> wanted_runs(const Campaign& c) {
  std::vector<std::size_t> list;
  // Numerics first: a campaign whose numbers are not converged is best known early.
  for (std::size_t i = 0; i < 2 * static_cast<std::size_t>(c.numerics_runs); ++i) list.push_back(numerics_begin + i);
  for (std::size_t i = 0; i < static_cast<std::size_t>(c.num_runs()); ++i) list.push_back(i);
  return list;
}

Work make_work(const Campaign& campaign, int threads, const std::function<DesignPoint(std::size_t)>& point) {
  return [campaign, threads, point](std::size_t task, const GoOn& go_on) -> std::string {
    const std::optional<RunResult> result = simulate_run(campaign, point(task), threads, go_on);
    return result ? pack_run(campaign, *result) : "";
  };
}
Work first_wave(const Campaign& campaign, int threads) {
  return make_work(campaign, threads,
                   [campaign](std::size_t run) { return design_point(campaign, run, numerics_begin); });
}

/// Tasks of the second wave: ten thousand numbers a box.
constexpr std::size_t local_begin = 10'000'000, box_size = 10'000;
struct LocalTask {
  std::size_t box, run;
};
LocalTask local_task(std::size_t task) { return {(task - local_begin) / box_size, (task - local_begin) % box_size}; }

Work second_wave(const Campaign& campaign, int threads, const std::vector<LocalCentre>& boxes) {
  return make_work(campaign, threads, [campaign, boxes](std::size_t task) {
    const LocalTask at = local_task(task);
    return local_point(campaign, boxes[at.box], at.run);
  });
}

/// A job for the other ranks: path of the campaign, number of boxes, the boxes (none: the first wave), and what they must find there.
std::string job_text(const Campaign& campaign, const std::vector<LocalCentre>& boxes) {
  std::string out = fmt::format("{}\n{}\n", fs::absolute(campaign.path).string(), boxes.size());
  for (const LocalCentre& box : boxes) {
    out += fmt::format("{} {}", box.effects.size(), box.x.size());
    for (const int effect : box.effects) out += fmt::format(" {}", effect);
    for (const Eigen::VectorXd* numbers : {&box.x, &box.half_width})
      for (const double number : *numbers) out += fmt::format(" {}", number);
    out += '\n';
  }
  return out + campaign.fingerprint();
}
std::vector<LocalCentre> read_boxes(std::istream& in) {
  std::size_t num_boxes = 0;
  in >> num_boxes;
  std::vector<LocalCentre> boxes(num_boxes);
  for (LocalCentre& box : boxes) {
    std::size_t num_effects = 0, dimensions = 0;
    in >> num_effects >> dimensions;
    box.effects.resize(num_effects);
    box.x.resize(static_cast<Index>(dimensions));
    box.half_width.resize(static_cast<Index>(dimensions));
    for (int& effect : box.effects) in >> effect;
    for (double& number : box.x) in >> number;
    for (double& number : box.half_width) in >> number;
  }
  in.ignore();  // the end of the line
  return boxes;
}

/// Whether a stored run is there and whole; a damaged one is set aside.
bool is_stored(const std::string& path, Reporter& reporter) {
  if (!fs::exists(path)) return false;
  try {
    verify_seal(read_whole_file(path), path);
    return true;
  } catch (const StoreError& error) {
    reporter.warn(set_aside(path, error.what()));
    return false;
  }
}

/// Says now and then how far the runs are.
std::function<void(std::size_t, std::size_t)> progress_of(Reporter& reporter, const std::size_t& before,
                                                          const std::size_t& total) {
  const auto begin = std::chrono::steady_clock::now();
  return [&reporter, &before, &total, begin, said = begin](std::size_t done, std::size_t running) mutable {
    const auto now = std::chrono::steady_clock::now();
    if (now - said < std::chrono::seconds(30) || done == 0) return;
    said = now;
    const double per_run = std::chrono::duration<double>(now - begin).count() / static_cast<double>(done);
    reporter.info(fmt::format("{} of {} runs, {} running, about {} left", before + done, total, running,
                              clock_text(per_run * static_cast<double>(total - before - done))));
  };
}

}  // namespace

TaskOutcome run_campaign(Farm& farm, const Campaign& campaign, const std::string& folder, int threads,
                         Reporter& reporter, const PlanSecondWave& plan) {
  const CampaignStore store{folder};
  std::optional<OutputLock> lock;
  try {
    store.check(campaign);
    make_folder(folder);
    lock.emplace(folder + "/lock");
    store.open(campaign);
    reporter.log_to(folder + "/run.log");
  } catch (...) {
    // The others wait for a job.
    farm.send_all(Tag::stop, "");
    farm.close();
    throw;
  }
  TaskJob job;
  const std::vector<std::size_t> wanted = wanted_runs(campaign);
  for (const std::size_t run : wanted)
    if (!is_stored(store.run_path(run), reporter)) job.tasks.push_back(run);
  std::size_t before = wanted.size() - job.tasks.size(), total = wanted.size();
  reporter.info(fmt::format("diagnosis \"{}\": {} runs of {} conditions, {} there already, on {} rank{}, into {}",
                            campaign.name, total, campaign.conditions.size(), before, farm.size(),
                            farm.size() == 1 ? "" : "s", folder));
  std::vector<LocalCentre> boxes;
  job.text = job_text(campaign, {});
  job.work = first_wave(campaign, threads);
  job.store = [&](std::size_t task, const std::string& bytes) {
    const LocalTask at = local_task(task);
    write_durably(task < local_begin ? store.run_path(task) : store.local_path(boxes[at.box], at.run), bytes);
  };
  job.progress = progress_of(reporter, before, total);
  job.more = [&] {
    boxes = plan();
    MoreTasks more{job_text(campaign, boxes), {}, second_wave(campaign, threads, boxes)};
    std::size_t num = 0;
    for (std::size_t b = 0; b < boxes.size(); ++b) {
      make_folder(fs::path(store.local_path(boxes[b], 0)).parent_path().string());
      for (std::size_t i = 0; i < num_local_runs(campaign, boxes[b]); ++i, ++num)
        if (!is_stored(store.local_path(boxes[b], i), reporter)) more.tasks.push_back(local_begin + b * box_size + i);
    }
    total += num;
    before += num - more.tasks.size();
    if (num > 0)
      reporter.info(fmt::format("second wave: {} runs close round {} explanations, {} there already", num, boxes.size(),
                                num - more.tasks.size()));
    return more;
  };
  return hand_out_tasks(farm, job);
}

void serve_campaign(Farm& farm, int threads) {
  serve_tasks(farm, [threads](const std::string& text) {
    std::istringstream in(text);
    std::string path;
    std::getline(in, path);
    const std::vector<LocalCentre> boxes = read_boxes(in);
    const Campaign campaign = read_campaign(path);
    if (job_text(campaign, boxes) != text)
      throw std::runtime_error(campaign.path + ": is not the same here as for rank 0, or was changed meanwhile");
    return boxes.empty() ? first_wave(campaign, threads) : second_wave(campaign, threads, boxes);
  });
}

namespace {

/// Round three pairs.
std::size_t most_local_runs(const Campaign& campaign) {
  if (campaign.second_wave == 0) return 0;
  const auto dimensions =
      static_cast<Index>(campaign.parameters.size() + std::min<std::size_t>(2, campaign.candidates.size()));
  return 3 * num_local_runs(campaign, {{}, Eigen::VectorXd::Zero(dimensions), Eigen::VectorXd::Ones(dimensions)});
}

}  // namespace

CampaignPlan plan_campaign(const Campaign& campaign, const std::string& folder) {
  const CampaignStore store{folder};
  if (!folder.empty()) store.check(campaign);
  CampaignPlan plan;
  plan.num_runs = static_cast<std::size_t>(campaign.num_runs());
  plan.num_numerics = 2 * static_cast<std::size_t>(campaign.numerics_runs);
  plan.most_local = most_local_runs(campaign);
  std::size_t finer = 0, plain = 0;
  for (const std::size_t run : wanted_runs(campaign)) {
    if (!folder.empty() && store.has(run))
      ++plan.stored;
    else
      ++(run >= numerics_begin && run % 2 == 1 ? finer : plain);
  }
  const std::optional<RunResult> one =
      simulate_run(campaign, design_point(campaign, 0, numerics_begin), 1, [] { return !stop_requested(); });
  plan.cpu_s_per_run = one ? one->cpu_s : std::nan("");
  // Twice the steps with four times the iterations: measured four to six times the time.
  plan.cpu_s_left = plan.cpu_s_per_run * (static_cast<double>(plain) + 5 * static_cast<double>(finer));
  return plan;
}

namespace {

/// What the data would have been in a run; `why` says what is missing.
Eigen::VectorXd outputs_of(const Campaign& c, const RunResult& r, const DesignPoint& point,
                           const MeasuredData& measured, std::string& why) {
  Eigen::VectorXd y(static_cast<Index>(measured.data.size()));
  for (Index i = 0; i < y.size(); ++i) {
    const Datum& d = measured.data[static_cast<std::size_t>(i)];
    const std::size_t condition = c.index_of(d.condition);
    y[i] = read_off(r.observables[condition], d.quantity, d.position);
    for (std::size_t k = 0; k < c.candidates.size(); ++k)
      y[i] = c.candidates[k].observe(d.condition, d.quantity, y[i],
                                     c.candidates[k].effect.strength(point.p[static_cast<Index>(k)]));
    if (!std::isfinite(y[i]) && why.empty())
      why = r.failure[condition].empty() ? fmt::format("no number for {}", name_of(d))
                                         : fmt::format("condition {}: {}", d.condition, r.failure[condition]);
  }
  return y;
}

/// The numerical error's candidate: what the runs of the other kind have shown. @param mean  finer - as is
void add_numerics(const Campaign& c, const DesignPoint& point, const Eigen::VectorXd& mean, Eigen::VectorXd& y) {
  for (std::size_t k = 0; k < c.candidates.size(); ++k)
    if (c.candidates[k].numerics) y += c.candidates[k].effect.strength(point.p[static_cast<Index>(k)]) * mean;
}

/// Points and outputs of the first `num` runs; of those without all numbers it is said why. @param wave  for that: "second wave, "
std::vector<std::pair<DesignPoint, Eigen::VectorXd>> complete_rows(
    const Campaign& c, const std::vector<RunResult>& results, std::size_t num, const MeasuredData& measured,
    const std::string& wave, CampaignOutputs& out, const std::function<DesignPoint(std::size_t)>& point_of) {
  Eigen::VectorXd numerics = Eigen::VectorXd::Zero(static_cast<Index>(measured.data.size()));
  if (out.numerics.rows() > 0) numerics = out.numerics.colwise().mean().transpose();
  std::vector<std::pair<DesignPoint, Eigen::VectorXd>> rows;
  for (std::size_t i = 0; i < num; ++i) {
    std::string why;
    const DesignPoint point = point_of(i);
    Eigen::VectorXd y = outputs_of(c, results[i], point, measured, why);
    add_numerics(c, point, numerics, y);
    out.cpu_s += results[i].cpu_s;
    if (why.empty())
      rows.emplace_back(point, std::move(y));
    else
      out.left_out.push_back(fmt::format("{}run {}: {}", wave, i, why));
  }
  return rows;
}

}  // namespace

CampaignOutputs read_off_runs(const Campaign& c, const std::vector<RunResult>& results, std::size_t num_design_runs,
                              const MeasuredData& measured) {
  const auto q = static_cast<Index>(measured.data.size());
  CampaignOutputs out;
  // Numerics first: a candidate may need their mean.
  std::vector<Eigen::VectorXd> difference;
  for (std::size_t i = num_design_runs; i + 1 < results.size(); i += 2) {
    std::string why;
    const DesignPoint plain = design_point(c, numerics_begin, numerics_begin);
    const Eigen::VectorXd coarse = outputs_of(c, results[i], plain, measured, why),
                          fine = outputs_of(c, results[i + 1], plain, measured, why);
    if (why.empty())
      difference.push_back(fine - coarse);
    else
      out.left_out.push_back(fmt::format("numerics pair {}: {}", (i - num_design_runs) / 2, why));
  }
  out.numerics.resize(static_cast<Index>(difference.size()), q);
  for (std::size_t i = 0; i < difference.size(); ++i)
    out.numerics.row(static_cast<Index>(i)) = difference[i].transpose();

  const auto rows = complete_rows(c, results, std::min(num_design_runs, results.size()), measured, "", out,
                                  [&](std::size_t i) { return design_point(c, i, numerics_begin); });
  const auto num = static_cast<Index>(rows.size());
  out.runs.parameters.resize(num, static_cast<Index>(c.parameters.size()));
  out.runs.strengths.resize(num, static_cast<Index>(c.candidates.size()));
  out.runs.outputs.resize(num, q);
  for (Index i = 0; i < num; ++i) {
    const auto& [point, y] = rows[static_cast<std::size_t>(i)];
    out.runs.parameters.row(i) = point.u.transpose();
    out.runs.strengths.row(i) = point.p.transpose();
    out.runs.outputs.row(i) = y.transpose();
  }
  return out;
}

void read_off_local(const Campaign& c, const LocalCentre& box, const std::vector<RunResult>& results,
                    const MeasuredData& measured, CampaignOutputs& out) {
  const auto rows = complete_rows(c, results, results.size(), measured, "second wave, ", out,
                                  [&](std::size_t i) { return local_point(c, box, i); });
  const auto num = static_cast<Index>(rows.size()), num_parameters = static_cast<Index>(c.parameters.size());
  LocalRuns runs{box, Eigen::MatrixXd(num, box.x.size()),
                 Eigen::MatrixXd(num, static_cast<Index>(measured.data.size()))};
  for (Index i = 0; i < num; ++i) {
    const auto& [point, y] = rows[static_cast<std::size_t>(i)];
    for (Index j = 0; j < box.x.size(); ++j)
      runs.x(i, j) =
          j < num_parameters ? point.u[j] : point.p[box.effects[static_cast<std::size_t>(j - num_parameters)]];
    runs.outputs.row(i) = y.transpose();
  }
  out.local.push_back(std::move(runs));
}

CampaignOutputs read_runs(const Campaign& c, const std::string& folder, const MeasuredData& measured,
                          const std::vector<LocalCentre>& second_wave) {
  const CampaignStore store{folder};
  const auto load = [&](const std::string& path) { return unpack_run(read_whole_file(path), c, path); };
  std::vector<RunResult> results;
  for (std::size_t i = 0; i < static_cast<std::size_t>(c.num_runs()); ++i) results.push_back(load(store.run_path(i)));
  for (std::size_t i = 0; i < 2 * static_cast<std::size_t>(c.numerics_runs); ++i)
    results.push_back(load(store.run_path(numerics_begin + i)));
  CampaignOutputs out = read_off_runs(c, results, static_cast<std::size_t>(c.num_runs()), measured);
  for (const LocalCentre& box : second_wave) {
    results.clear();
    for (std::size_t i = 0; i < num_local_runs(c, box); ++i) results.push_back(load(store.local_path(box, i)));
    read_off_local(c, box, results, measured, out);
  }
  return out;
}

}  // namespace drumsweep
