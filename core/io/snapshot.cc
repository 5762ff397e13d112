#include "core/io/snapshot.h"

#include <fmt/format.h>

#include <cstdlib>
#include <sstream>

#include "core/config/schema.h"
#include "core/config/toml_reader.h"
#include "core/io/h5md.h"

namespace drumsweep {
namespace {

constexpr const char* warm_kind = "warm_state";
constexpr const char* recording_kind = "recording";
constexpr const char* progress_kind = "design_progress";
constexpr int warm_layout = 3;
constexpr int recording_layout = 3;
constexpr int progress_layout = 1;
constexpr const char* attempt_line = "attempt ";

/// Study without its stages: what a state or a recording may depend on.
std::string study_text(Study study) {
  study.stages.clear();
  return write_study(study, false);
}

void write_counts(Hdf5Writer& file, const Counts& c) {
  file.attribute("fed", c.fed);
  file.attribute("landed", c.landed);
  file.attribute("spilled", c.spilled);
  file.attribute("removed", c.removed);
}

Counts read_counts(const Hdf5Reader& file) {
  return {file.integer("fed"), file.integer("landed"), file.integer("spilled"), file.integer("removed")};
}

/// Turns of rolling and twisting resistance, or nothing when there are none.
void append_turn(std::vector<float>& list, const std::vector<Turn>& turns, std::size_t i) {
  if (i < turns.size()) list.insert(list.end(), turns[i].begin(), turns[i].end());
}

/// Balls as H5MD has them; what else a bitwise restart needs is in /drumsweep.
void write_state(Hdf5Writer& file, const DrumState& s, const Physics& physics) {
  file.attribute("num_steps", s.num_steps);
  file.attribute("feed_debt_kg", s.feed_debt_kg);
  write_counts(file, s.counts);
  write_h5md(file, s.balls, physics.material, s.num_steps,
             static_cast<double>(s.num_steps) * physics.solver.outer_step_s);

  // Only pairs that press carry an impulse to the next step.
  std::vector<std::uint32_t> pair, ball;
  std::vector<float> pair_impulse, pair_turn, wall_direction, wall_impulse, wall_turn;
  for (std::size_t i = 0; i < s.pairs.size(); ++i) {
    const PairImpulse& p = s.pairs[i];
    if (!(p.normal > 0)) continue;
    append_turn(pair_turn, s.pair_turns, i);
    pair.insert(pair.end(), {p.a, p.b});
    pair_impulse.insert(pair_impulse.end(), {p.tangent[0], p.tangent[1], p.tangent[2], p.normal});
  }
  for (std::size_t i = 0; i < s.walls.size(); ++i) {
    const WallImpulse& w = s.walls[i];
    append_turn(wall_turn, s.wall_turns, i);
    ball.push_back(w.ball);
    wall_direction.insert(wall_direction.end(), {w.direction[0], w.direction[1], w.direction[2]});
    wall_impulse.insert(wall_impulse.end(), {w.tangent[0], w.tangent[1], w.tangent[2], w.normal});
  }
  file.dataset("drumsweep/pairs/balls", pair, 2, "1", "rows of /particles/balls that press on each other");
  file.dataset("drumsweep/pairs/impulse", pair_impulse, 4, "N s", "on the first: tangential part, normal part");
  file.dataset("drumsweep/walls/ball", ball, 1, "1", "row of /particles/balls that presses on the wall");
  file.dataset("drumsweep/walls/direction", wall_direction, 3, "1", "normal towards the ball, in the drum's frame");
  file.dataset("drumsweep/walls/impulse", wall_impulse, 4, "N s",
               "on the ball, in the drum's frame: tangential part, normal part");
  file.dataset("drumsweep/pairs/turn", pair_turn, 3, "N s",
               "torque impulse over the arm; empty without rolling resistance");
  file.dataset("drumsweep/walls/turn", wall_turn, 3, "N s", "the same at the wall");
}

DrumState read_state(const Hdf5Reader& file) {
  DrumState s;
  s.num_steps = file.integer("num_steps");
  s.feed_debt_kg = file.real("feed_debt_kg");
  s.counts = read_counts(file);
  s.balls = read_h5md(file);
  const auto pair = file.uint32s("drumsweep/pairs/balls"), ball = file.uint32s("drumsweep/walls/ball");
  const auto p = file.floats("drumsweep/pairs/impulse"), d = file.floats("drumsweep/walls/direction"),
             w = file.floats("drumsweep/walls/impulse");
  for (std::size_t i = 0; i < pair.size() / 2; ++i)
    s.pairs.push_back({pair[2 * i], pair[2 * i + 1], {p[4 * i], p[4 * i + 1], p[4 * i + 2]}, p[4 * i + 3]});
  for (std::size_t i = 0; i < ball.size(); ++i)
    s.walls.push_back(
        {ball[i], 0, {d[3 * i], d[3 * i + 1], d[3 * i + 2]}, {w[4 * i], w[4 * i + 1], w[4 * i + 2]}, w[4 * i + 3]});
  const auto turns = [&](const char* name) {
    const auto values = file.floats(name);
    std::vector<Turn> list(values.size() / 3);
    for (std::size_t i = 0; i < list.size(); ++i) list[i] = {values[3 * i], values[3 * i + 1], values[3 * i + 2]};
    return list;
  };
  s.pair_turns = turns("drumsweep/pairs/turn");
  s.wall_turns = turns("drumsweep/walls/turn");
  return s;
}

/// Another version of the program may compute other bits: its results must not be mixed with ours.
void refuse_other_version(const Hdf5Reader& file, const std::string& source) {
  const std::string version = file.text("program_version");
  if (version != DRUMSWEEP_VERSION)
    throw MismatchError(fmt::format("{}: was made by drumsweep {}, this is {}; use that version, or another folder",
                                    source, version, DRUMSWEEP_VERSION));
}

void refuse_differences(const Study& stored, const Study& study, bool recording_too, const std::string& source) {
  const std::string text = explain_differences(stored, study, recording_too);
  if (!text.empty()) throw MismatchError(fmt::format("{}: was made with other settings:\n{}", source, text));
}

std::string keys_of(const Design& design) {
  std::string keys;
  for (const auto& [key, value] : design) keys += (keys.empty() ? "" : ",") + key;
  return keys;
}

std::vector<double> values_of(const Design& design) {
  std::vector<double> values;
  for (const auto& [key, value] : design) values.push_back(value);
  return values;
}

void write_identity(Hdf5Writer& file, const Study& study, const std::string& design_id, const Design& design) {
  file.attribute("study", study_text(study));
  file.attribute("program_version", std::string(DRUMSWEEP_VERSION));
  file.attribute("design_id", design_id);
  file.attribute("design_keys", keys_of(design));
  file.dataset("design", values_of(design), 1, "in the keys", "values of design_keys");
}

Design design_of(const Hdf5Reader& file, const std::string& source) {
  Design design;
  std::istringstream keys(file.text("design_keys"));
  std::string key;
  for (const double value : file.doubles("design")) {
    if (!std::getline(keys, key, ',')) throw StoreError(source + ": damaged: a value without a key");
    design.emplace_back(key, value);
  }
  return design;
}

void refuse_other_design(const Hdf5Reader& file, const Study& study, const std::string& design_id, const Design& design,
                         const std::string& source) {
  refuse_other_version(file, source);
  if (file.text("design_id") != design_id || file.text("design_keys") != keys_of(design) ||
      file.doubles("design") != values_of(design))
    throw MismatchError(fmt::format("{}: holds design {} ({}), not design {} ({})", source, file.text("design_id"),
                                    file.text("design_keys"), design_id, keys_of(design)));
  refuse_differences(parse_study(file.text("study"), source + ": study"), study, true, source);
}

void write_landings(Hdf5Writer& file, const std::vector<Landing>& landings) {
  std::vector<double> time, place;
  std::vector<float> velocity, radius;
  std::vector<std::uint32_t> id;
  std::vector<std::uint8_t> exit;
  for (const Landing& l : landings) {
    time.push_back(l.time);
    place.insert(place.end(), {l.x, l.y});
    velocity.insert(velocity.end(), {l.vx, l.vy, l.vz});
    radius.push_back(l.radius);
    id.push_back(l.ball_id);
    exit.push_back(l.exit);
  }
  file.dataset("landings/time", time, 1, "s", "simulation time of the landing");
  file.dataset("landings/place", place, 2, "m", "along the belt (in the room) and across it from its edge");
  file.dataset("landings/velocity", velocity, 3, "m s-1", "");
  file.dataset("landings/radius", radius, 1, "m", "");
  file.dataset("landings/ball_id", id, 1, "1", "");
  file.dataset("landings/exit", exit, 1, "1", "1... slot, 255 over the outlet's end");
}

std::vector<Landing> read_landings(const Hdf5Reader& file) {
  std::vector<Landing> landings;
  const auto time = file.doubles("landings/time"), place = file.doubles("landings/place");
  const auto velocity = file.floats("landings/velocity"), radius = file.floats("landings/radius");
  const auto id = file.uint32s("landings/ball_id");
  const auto exit = file.uint8s("landings/exit");
  for (std::size_t i = 0; i < time.size(); ++i)
    landings.push_back({time[i], place[2 * i], place[2 * i + 1], velocity[3 * i], velocity[3 * i + 1],
                        velocity[3 * i + 2], radius[i], id[i], exit[i]});
  return landings;
}

}  // namespace

std::string explain_differences(const Study& stored, const Study& given, bool recording_too) {
  std::string text;
  for (const Difference& d : differences(stored, given))
    if (d.scope == Scope::warm_state || (recording_too && d.scope == Scope::recording))
      text += fmt::format("  {}: stored {}, now {}\n", d.key, d.stored, d.given);
  return text;
}

std::string pack_warm_state(const Study& study, const WarmState& warm) {
  Hdf5Writer file;
  file.attribute("study", study_text(study));
  file.attribute("program_version", std::string(DRUMSWEEP_VERSION));
  file.attribute("finished", std::int64_t{warm.finished});
  file.attribute("steady", std::int64_t{warm.steady});
  write_state(file, warm.state, study);
  std::vector<double> turns;
  std::vector<std::int64_t> flow;
  for (const WarmupWindow& w : warm.windows) {
    turns.push_back(w.turns_end);
    flow.insert(flow.end(), {w.fed, w.left, w.inside});
  }
  file.dataset("drumsweep/warmup/turns_end", turns, 1, "1", "end of each window, in turns since the empty drum");
  file.dataset("drumsweep/warmup/flow", flow, 3, "1", "balls fed and left in the window, inside at its end");
  return file.seal(warm_kind, warm_layout);
}

StoredDrum unpack_drum(const std::string& bytes, const std::string& source) {
  const Hdf5Reader file(bytes, warm_kind, warm_layout, source);
  refuse_other_version(file, source);
  StoredDrum stored{parse_study(file.text("study"), source + ": study"), {}};
  WarmState& warm = stored.warm;
  warm.state = read_state(file);
  warm.finished = file.integer("finished") != 0;
  warm.steady = file.integer("steady") != 0;
  const auto turns = file.doubles("drumsweep/warmup/turns_end");
  const auto flow = file.int64s("drumsweep/warmup/flow");
  for (std::size_t i = 0; i < turns.size(); ++i)
    warm.windows.push_back({turns[i], flow[3 * i], flow[3 * i + 1], flow[3 * i + 2]});
  return stored;
}

WarmState unpack_warm_state(const std::string& bytes, const Study& study, const std::string& source) {
  StoredDrum stored = unpack_drum(bytes, source);
  refuse_differences(stored.study, study, false, source);
  return std::move(stored.warm);
}

std::string pack_recording(const Study& study, const std::string& design_id, const Design& design, const Recording& r) {
  Hdf5Writer file;
  write_identity(file, study, design_id, design);
  file.attribute("begin_s", r.begin_s);
  file.attribute("turns", r.turns);
  write_counts(file, r.counts);
  file.attribute("inside", r.inside);
  file.attribute("lost", r.lost);
  file.attribute("feed_debt_kg", r.feed_debt_kg);
  file.attribute("residual_mean_m_s", r.quality.residual.mean);
  file.attribute("residual_max_m_s", r.quality.residual.max);
  file.attribute("overlap_mean", r.quality.mean_overlap);
  file.attribute("overlap_95", r.quality.overlap_95);
  file.attribute("overlap_max", r.quality.max_overlap);
  file.attribute("force_balance_m_s", r.quality.force_balance);
  file.attribute("iterations", r.quality.iterations);
  file.dataset("quality/of_steps", r.quality_of_steps, quality_columns.size(), "in the columns",
               fmt::format("of each recorded outer step: {}", fmt::join(quality_columns, ", ")));
  file.attribute("num_contacts", static_cast<std::int64_t>(r.quality.num_contacts));
  file.attribute("num_rows", static_cast<std::int64_t>(r.quality.num_rows));
  file.attribute("state_hash", fmt::format("{:016x}", r.hash));
  write_landings(file, r.landings);
  return file.seal(recording_kind, recording_layout);
}

Recording unpack_recording(const std::string& bytes, const Study& study, const std::string& design_id,
                           const Design& design, const std::string& source) {
  return read_recording(Hdf5Reader(bytes, recording_kind, recording_layout, source), study, design_id, design, source);
}

Recording read_recording(const Hdf5Reader& file, const Study& study, const std::string& design_id, const Design& design,
                         const std::string& source) {
  refuse_other_design(file, study, design_id, design, source);
  Recording r;
  r.begin_s = file.real("begin_s");
  r.turns = file.real("turns");
  r.counts = read_counts(file);
  r.inside = file.integer("inside");
  r.lost = file.integer("lost");
  r.feed_debt_kg = file.real("feed_debt_kg");
  r.quality.residual = {file.real("residual_max_m_s"), file.real("residual_mean_m_s")};
  r.quality.mean_overlap = file.real("overlap_mean");
  r.quality.overlap_95 = file.real("overlap_95");
  r.quality.max_overlap = file.real("overlap_max");
  r.quality.force_balance = file.real("force_balance_m_s");
  r.quality.iterations = file.real("iterations");
  r.quality_of_steps = file.floats("quality/of_steps");
  r.quality.num_contacts = static_cast<std::size_t>(file.integer("num_contacts"));
  r.quality.num_rows = static_cast<std::size_t>(file.integer("num_rows"));
  r.hash = std::stoull(file.text("state_hash"), nullptr, 16);
  r.landings = read_landings(file);
  return r;
}

std::string pack_progress(const Study& study, const std::string& design_id, const Design& design,
                          const DesignProgress& progress, int attempt) {
  Hdf5Writer file;
  write_identity(file, study, design_id, design);
  file.attribute("attempt", std::int64_t{attempt});
  write_state(file, progress.state, study);
  write_landings(file, progress.landings);
  file.dataset("quality/of_steps", progress.quality_of_steps, quality_columns.size(), "in the columns",
               fmt::format("of each recorded outer step: {}", fmt::join(quality_columns, ", ")));
  const StepReport& sum = progress.quality.sum();
  const std::vector<double> sums = {sum.residual.mean, sum.residual.max, sum.iterations,   sum.max_overlap,
                                    sum.overlap_95,    sum.mean_overlap, sum.force_balance};
  file.dataset(
      "quality/sums", sums, 1, "SI",
      "over the recorded steps: mean residual, max residual (largest), iterations, max overlap (largest), 95 % "
      "overlap, mean overlap, force balance (largest)");
  const std::vector<std::int64_t> numbers = {progress.quality.num(), static_cast<std::int64_t>(sum.num_contacts),
                                             static_cast<std::int64_t>(sum.num_rows),
                                             static_cast<std::int64_t>(sum.residual.num_rows)};
  file.dataset("quality/numbers", numbers, 1, "1", "steps; sums of contacts, rows and the residual's rows");
  std::string bytes = file.seal(progress_kind, progress_layout);
  // Into the rest of the user block, which is not part of the image: it can be read without the image.
  const std::string line = fmt::format("{}{}\n", attempt_line, attempt);
  bytes.replace(bytes.find('\n') + 1, line.size(), line);
  return bytes;
}

int attempt_in_head(const std::string& second_line) {
  const std::string begin = attempt_line;
  return second_line.rfind(begin, 0) == 0 ? std::atoi(second_line.c_str() + begin.size()) : 0;
}

StoredProgress unpack_progress(const std::string& bytes, const Study& study, const std::string& design_id,
                               const Design& design, const std::string& source) {
  const Hdf5Reader file(bytes, progress_kind, progress_layout, source);
  refuse_other_design(file, study, design_id, design, source);
  StoredProgress stored{{}, static_cast<int>(file.integer("attempt"))};
  DesignProgress& progress = stored.progress;
  progress.begun = true;
  progress.state = read_state(file);
  progress.landings = read_landings(file);
  progress.quality_of_steps = file.floats("quality/of_steps");
  const auto sums = file.doubles("quality/sums");
  const auto numbers = file.int64s("quality/numbers");
  StepReport sum;
  sum.residual.mean = sums.at(0);
  sum.residual.max = sums.at(1);
  sum.iterations = sums.at(2);
  sum.max_overlap = sums.at(3);
  sum.overlap_95 = sums.at(4);
  sum.mean_overlap = sums.at(5);
  sum.force_balance = sums.at(6);
  sum.num_contacts = static_cast<std::size_t>(numbers.at(1));
  sum.num_rows = static_cast<std::size_t>(numbers.at(2));
  sum.residual.num_rows = static_cast<std::size_t>(numbers.at(3));
  progress.quality = ReportMean(sum, numbers.at(0));
  return stored;
}

DrumMoment unpack_drum_moment(const std::string& bytes, const std::string& source) {
  if (verify_seal(bytes, source).kind != progress_kind) {
    StoredDrum drum = unpack_drum(bytes, source);
    const OutletConfig outlet = warmup_outlet(drum.study);
    return {std::move(drum.study), outlet, std::move(drum.warm.state)};
  }
  const Hdf5Reader file(bytes, progress_kind, progress_layout, source);
  refuse_other_version(file, source);
  const Study study = study_of_design(parse_study(file.text("study"), source + ": study"), design_of(file, source));
  return {study, study.outlet, read_state(file)};
}

std::string repack_recording(const Hdf5Reader& file, const std::string& source) {
  const Study study = parse_study(file.text("study"), source + ": study");
  const std::string id = file.text("design_id");
  const Design design = design_of(file, source);
  return pack_recording(study, id, design, read_recording(file, study, id, design, source));
}

}  // namespace drumsweep
