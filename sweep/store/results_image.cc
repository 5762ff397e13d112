#include "sweep/store/results_image.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <exception>

#include "core/config/schema.h"
#include "core/config/toml_reader.h"
#include "core/io/durable_file.h"
#include "core/io/hdf5_image.h"
#include "sweep/store/results.h"

namespace drumsweep {
namespace {

constexpr const char* kind = "results";
constexpr int layout = 1;
constexpr std::size_t num_confirmed = 10;

/// A column of the table: member, unit and meaning.
template <class Value>
struct Column {
  const char* name;
  Value ResultRow::*value;
  const char* unit;
  const char* long_name;
};
constexpr std::array<Column<std::string>, 3> first_texts = {{
    {"design_id", &ResultRow::design_id, "1", "hash of the design's values"},
    {"stage", &ResultRow::stage, "1", "first stage of the study in which the design occurs"},
    {"state", &ResultRow::state, "1", "done, untrusted or failed"},
}};
constexpr std::array<Column<double>, 6> first_numbers = {{
    {"f_m", &ResultRow::f_m, "m", "objective: unevenness of the bed on the belt"},
    {"sigma_f_m", &ResultRow::sigma_f_m, "m", "standard error of f_m"},
    {"f_footprint_m", &ResultRow::f_footprint_m, "m", "objective over the outlet's footprint"},
    {"sigma_f_footprint_m", &ResultRow::sigma_f_footprint_m, "m", "standard error of f_footprint_m"},
    {"max_an_over_a0", &ResultRow::max_an_over_a0, "1", "largest Fourier coefficient of the bed over its mean"},
    {"mean_height_m", &ResultRow::mean_height_m, "m", "mean height of the bed"},
}};
constexpr std::array<Column<std::int64_t>, 2> counts = {{
    {"landed", &ResultRow::landed, "1", "balls that landed on the belt in the recorded turns"},
    {"lost_balls", &ResultRow::lost_balls, "1", "balls found where none can be"},
}};
constexpr std::array<Column<double>, 4> last_numbers = {{
    {"residual", &ResultRow::residual, "m s-1", "solver: mean residual (natural map)"},
    {"overlap_95", &ResultRow::overlap_95, "1", "95 % of pressed contacts overlap less, over the diameter"},
    {"force_balance_m_s", &ResultRow::force_balance_m_s, "m s-1", "solver: largest force balance error of a ball"},
    {"iterations", &ResultRow::iterations, "1", "solver: mean number of iterations"},
}};
constexpr std::array<Column<std::string>, 2> last_texts = {{
    {"state_hash", &ResultRow::state_hash, "1", "hash of the final state"},
    {"reason", &ResultRow::reason, "1", "why a design is not done"},
}};

/// Unit of a design variable: the ending of its name, longer ones first.
std::string unit_of(const std::string& column) {
  for (const auto& [ending, unit] :
       {std::pair("_rad_s", "rad s-1"), std::pair("_kg_m3", "kg m-3"), std::pair("_kg_s", "kg s-1"),
        std::pair("_m_s", "m s-1"), std::pair("_deg", "degree"), std::pair("_rad", "rad"), std::pair("_Pa", "Pa"),
        std::pair("_N", "N"), std::pair("_m", "m"), std::pair("_s", "s")})
    if (column.ends_with(ending)) return unit;
  return "as in the name";
}

/// What happened to a design, over all runs.
struct History {
  std::string host;  ///< of the last event that has one
  std::int64_t attempts = 0;
  double wall_s = 0, cpu_s = 0;
};

std::map<std::string, History> histories(const std::vector<ProvenanceLine>& lines) {
  std::map<std::string, History> all;
  for (const ProvenanceLine& line : lines) {
    if (line.design_id.empty()) continue;
    History& h = all[line.design_id];
    h.attempts += line.event == "started" ? 1 : 0;
    if (!line.host.empty()) h.host = line.host;
    h.wall_s += line.wall_s;
    h.cpu_s += line.cpu_s;
  }
  return all;
}

/// One column of all rows, by a function of the row.
template <class Value, class Get>
std::vector<Value> collect(const ResultTable& table, const Get& get) {
  std::vector<Value> values;
  values.reserve(table.rows.size());
  for (const ResultRow& row : table.rows) values.push_back(get(row));
  return values;
}

bool same_row(const ResultRow& a, const ResultRow& b) {
  const std::vector<std::string> names(a.variables.size(), "x");
  return a.variables.size() == b.variables.size() && to_csv({names, {a}}) == to_csv({names, {b}});
}

}  // namespace

std::string pack_results(const Study& study, const ResultTable& table, bool steady, const RecordingIndex& recordings,
                         const std::vector<ProvenanceLine>& provenance) {
  Hdf5Writer file;
  file.attribute("program_version", std::string(DRUMSWEEP_VERSION));
  file.attribute("seed", study.seed);
  file.attribute("steady", std::int64_t{steady});
  file.texts("study", {write_study(study, false)}, "study file that made the results");

  std::vector<std::string> columns;
  const auto add_texts = [&](const auto& list) {
    for (const auto& c : list) {
      file.texts(std::string("results/") + c.name,
                 collect<std::string>(table, [&](const ResultRow& row) { return row.*c.value; }), c.long_name);
      columns.emplace_back(c.name);
    }
  };
  const auto add_numbers = [&]<class Value>(const Value&, const auto& list) {
    for (const auto& c : list) {
      file.dataset(std::string("results/") + c.name,
                   collect<Value>(table, [&](const ResultRow& row) { return row.*c.value; }), 1, c.unit, c.long_name);
      columns.emplace_back(c.name);
    }
  };
  add_texts(first_texts);
  for (std::size_t v = 0; v < table.variable_names.size(); ++v) {
    const std::string& name = table.variable_names[v];
    file.dataset("results/" + name, collect<double>(table, [&](const ResultRow& row) { return row.variables.at(v); }),
                 1, unit_of(name), "design variable");
    columns.push_back(name);
  }
  add_numbers(0.0, first_numbers);
  add_numbers(std::int64_t{0}, counts);
  add_numbers(0.0, last_numbers);
  add_texts(last_texts);
  file.attribute("columns", columns, "results");
  file.texts("variables", table.variable_names, "columns of /results that are design variables");

  std::vector<std::uint32_t> crc;
  std::vector<std::int64_t> bytes, attempts;
  std::vector<std::string> host;
  std::vector<double> wall, cpu;
  const auto past = histories(provenance);
  for (const ResultRow& row : table.rows) {
    const Checksum checksum = recordings.verified(row.design_id).value_or(Checksum{});
    crc.push_back(checksum.crc);
    bytes.push_back(static_cast<std::int64_t>(checksum.bytes));
    const auto found = past.find(row.design_id);
    const History h = found == past.end() ? History{} : found->second;
    host.push_back(h.host);
    attempts.push_back(h.attempts);
    wall.push_back(h.wall_s);
    cpu.push_back(h.cpu_s);
  }
  file.dataset("recordings/crc32", crc, 1, "1", "of the recording that the row was computed from");
  file.dataset("recordings/bytes", bytes, 1, "1", "its size");
  file.texts("provenance/host", host, "where it was simulated last");
  file.dataset("provenance/attempts", attempts, 1, "1", "how often it was begun");
  file.dataset("provenance/wall_s", wall, 1, "s", "wall time of all attempts that ended");
  file.dataset("provenance/cpu_s", cpu, 1, "s", "CPU time of all attempts that ended");
  return file.seal(kind, layout);
}

ResultTable unpack_results(const std::string& bytes, const std::string& source) {
  const Hdf5Reader file(bytes, kind, layout, source);
  if (file.text("program_version") != DRUMSWEEP_VERSION)
    throw MismatchError(source + ": was made by drumsweep " + file.text("program_version"));
  ResultTable table;
  table.variable_names = file.texts("variables");
  table.rows.resize(file.texts("results/design_id").size());
  const auto fill = [&](const auto& list, const auto& read) {
    for (const auto& c : list) {
      const auto values = read(std::string("results/") + c.name);
      for (std::size_t i = 0; i < table.rows.size(); ++i) table.rows[i].*c.value = values.at(i);
    }
  };
  const auto texts = [&](const std::string& name) { return file.texts(name); };
  const auto numbers = [&](const std::string& name) { return file.doubles(name); };
  fill(first_texts, texts);
  for (const std::string& name : table.variable_names) {
    const std::vector<double> values = file.doubles("results/" + name);
    for (std::size_t i = 0; i < table.rows.size(); ++i) table.rows[i].variables.push_back(values.at(i));
  }
  fill(first_numbers, numbers);
  fill(counts, [&](const std::string& name) { return file.int64s(name); });
  fill(last_numbers, numbers);
  fill(last_texts, texts);
  return table;
}

KnownRows::KnownRows(const std::string& path, const Study& study, bool steady) {
  try {
    const std::string bytes = read_whole_file(path);
    const ResultTable table = unpack_results(bytes, path);
    const Hdf5Reader file(bytes, kind, layout, path);
    if ((file.integer("steady") != 0) != steady) return;
    const Study stored = parse_study(file.texts("study").at(0), path + ": study");
    for (const Difference& d : differences(stored, study))
      if (d.scope != Scope::label) return;
    const auto crc = file.uint32s("recordings/crc32");
    const auto size = file.int64s("recordings/bytes");
    for (std::size_t i = 0; i < table.rows.size(); ++i)
      if (size.at(i) > 0)
        rows_[table.rows[i].design_id] = {table.rows[i], {crc.at(i), static_cast<std::uint64_t>(size[i])}};
  } catch (const std::exception&) {
    rows_.clear();
  }
}

std::optional<ResultRow> KnownRows::find(const PlannedDesign& design, const Checksum& checksum) const {
  const auto found = rows_.find(design.id);
  if (found == rows_.end() || found->second.checksum != checksum) return std::nullopt;
  ResultRow row = found->second.row;
  row.stage = design.stage;
  row.variables = design.row;
  return row;
}

void KnownRows::confirm(RecordingIndex& recordings, const Study& study, const Plan& plan, bool steady) {
  const std::size_t step = std::max<std::size_t>(1, plan.designs.size() / num_confirmed);
  for (std::size_t i = 0; i < plan.designs.size() && !rows_.empty(); i += step) {
    const PlannedDesign& design = plan.designs[i];
    try {
      if (!recordings.has_recording(design.id)) continue;
      const auto known = find(design, recordings.verify(design.id));
      if (known && !same_row(*known, stored_row(recordings, {}, study, design, steady).value())) rows_.clear();
    } catch (const StoreError&) {
      // A damaged recording says nothing about the rows.
    }
  }
}

std::optional<ResultRow> stored_row(RecordingIndex& recordings, const KnownRows& known, const Study& study,
                                    const PlannedDesign& design, bool steady) {
  if (recordings.has_recording(design.id))
    if (auto row = known.find(design, recordings.verify(design.id))) return row;
  const StoredDesign stored = recordings.read(study, design);
  if (stored.recording) return evaluated_row(study, design, *stored.recording, steady);
  if (stored.failure) return failed_row(design, *stored.failure);
  return std::nullopt;
}

}  // namespace drumsweep
