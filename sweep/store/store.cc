#include "sweep/store/store.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <string_view>
#include <system_error>

#include "core/config/schema.h"
#include "core/config/toml_reader.h"
#include "core/io/durable_file.h"
#include "sweep/store/recordings.h"

namespace drumsweep {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view header_begin = "# drumsweep output folder, layout ";
constexpr std::string_view failure_begin = "drumsweep design ";

/// First line of the frozen study. Another version of the program may compute another drum, so it is part of it.
std::string header_line() { return fmt::format("{}1, program {}\n", header_begin, DRUMSWEEP_VERSION); }

std::string frozen_text(const Study& study) {
  return header_line() +
         "# Frozen copy of the study that made the results here. Change your own file, not this one.\n\n" +
         write_study(study, false);
}

bool is_leftover(const fs::path& path) { return path.extension() == ".tmp"; }

/// What a run may find and still call the folder empty: traces of one that was killed before it had frozen its study.
bool counts_as_empty(const std::string& folder) {
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if (name != "lock" && name != "run.log" && !is_leftover(entry.path())) return false;
  }
  return true;
}

/// Text of the frozen study, none for an empty folder. Reads only.
std::optional<std::string> frozen_study_text(const OutputPaths& paths) {
  std::error_code error;
  if (!fs::exists(paths.folder, error)) return std::nullopt;
  if (!fs::is_directory(paths.folder, error))
    throw InputError(fmt::format("{}: is there and is not a folder", paths.folder));
  if (!fs::exists(paths.study(), error)) {
    if (counts_as_empty(paths.folder)) return std::nullopt;
    throw MismatchError(
        fmt::format("{}: is not empty and not the output folder of a sweep; nothing was changed, choose "
                    "another folder",
                    paths.folder));
  }
  std::string text = read_whole_file(paths.study());
  const std::string first = text.substr(0, text.find('\n') + 1);
  if (first.rfind(header_begin, 0) != 0)
    throw MismatchError(
        fmt::format("{}: its study.toml is not one that a sweep has frozen, so the folder is something "
                    "else; nothing was changed, choose another folder",
                    paths.folder));
  if (first != header_line())
    throw MismatchError(fmt::format(
        "{}: belongs to another version of the program; nothing was changed\n  stored {}\n  "
        "this is {}",
        paths.folder, first.substr(2, first.size() - 3), header_line().substr(2, header_line().size() - 3)));
  return text;
}

void refuse_other_study(const OutputPaths& paths, const Study& stored, const Study& given) {
  const std::string text = explain_differences(stored, given, true);
  if (!text.empty())
    throw MismatchError(
        fmt::format("{}: was made with other settings; results of the two must not be mixed:\n{}Put the "
                    "keys back, or choose another output folder.",
                    paths.folder, text));
}

void remove_leftovers(const std::string& folder, std::vector<std::string>& notes) {
  std::vector<fs::path> leftovers;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder))
    if (is_leftover(entry.path())) leftovers.push_back(entry.path());
  for (const fs::path& path : leftovers) {
    std::error_code ignored;
    if (fs::remove(path, ignored)) notes.push_back(path.string() + ": removed, left behind by a run that was killed");
  }
}

}  // namespace

void make_folder(const std::string& path) {
  std::error_code error;
  fs::create_directories(path, error);
  if (error) throw WriteError(fmt::format("{}: folder cannot be made: {}", path, error.message()));
}

Store::Store(const std::string& folder, const Study& study) : paths_{folder} {
  // Look before anything is touched; look again under the lock, as another run may just have begun here.
  const auto check = [&] {
    const std::optional<std::string> text = frozen_study_text(paths_);
    if (!text) return std::optional<Study>();
    const Study stored = parse_study(*text, paths_.study());
    refuse_other_study(paths_, stored, study);
    return std::optional(stored);
  };
  check();
  make_folder(folder);
  lock_ = std::make_unique<OutputLock>(paths_.lock());
  if (!lock_->held())
    notes_.push_back(paths_.lock() + ": the file system gives no locks; make sure that no second run uses this folder");
  const std::optional<Study> stored = check();

  make_folder(paths_.designs());
  remove_leftovers(folder, notes_);
  remove_leftovers(paths_.designs(), notes_);

  if (!stored) {
    write_durably(paths_.study(), frozen_text(study));
  } else if (write_study(*stored, false) != write_study(study, false)) {
    for (const Difference& d : differences(*stored, study))
      notes_.push_back(
          fmt::format("{}: was {}, now {}; {}", d.key, d.stored, d.given,
                      d.scope == Scope::evaluation ? "stored landings are evaluated anew" : "only a label"));
    Study same_stages = study;
    same_stages.stages = stored->stages;
    if (write_study(same_stages, false) != write_study(study, false))
      notes_.push_back("the stages have changed: designs that are stored already are kept");
    write_durably(paths_.study(), frozen_text(study));
  }
}

Study read_frozen_study(const std::string& folder) {
  const OutputPaths paths{folder};
  std::error_code error;
  if (!fs::is_directory(folder, error) || !fs::exists(paths.study(), error))
    throw InputError(folder + ": is not the output folder of a sweep (no study.toml in it)");
  return parse_study(*frozen_study_text(paths), paths.study());
}

bool has_loose_recording(const OutputPaths& paths, const std::string& id) {
  std::error_code error;
  return fs::exists(paths.recording(id), error);
}

bool has_failure(const OutputPaths& paths, const std::string& id) {
  std::error_code error;
  return fs::exists(paths.failure(id), error);
}

StoredDesign read_design(const OutputPaths& paths, const Study& study, const PlannedDesign& design) {
  return RecordingIndex(paths).read(study, design);
}

std::string read_failure(const OutputPaths& paths, const std::string& id) {
  const std::string path = paths.failure(id), text = read_whole_file(path);
  const std::string head = fmt::format("{}{} failed\n", failure_begin, id);
  if (text.rfind(head, 0) != 0) throw StoreError(path + ": damaged: it does not begin as it should");
  return text.substr(head.size(), text.find('\n', head.size()) - head.size());
}

void write_recording(const OutputPaths& paths, const Study& study, const PlannedDesign& design,
                     const Recording& recording) {
  write_durably(paths.recording(design.id), pack_recording(study, design.id, design.values, recording));
}

void write_failure(const OutputPaths& paths, const PlannedDesign& design, const std::string& reason) {
  std::string line = reason;
  std::replace(line.begin(), line.end(), '\n', ' ');
  write_durably(paths.failure(design.id), fmt::format("{}{} failed\n{}\n", failure_begin, design.id, line));
}

std::optional<WarmState> read_warm_state(const std::string& path, const Study& study, std::string* bytes) {
  std::error_code error;
  if (!fs::exists(path, error)) return std::nullopt;
  std::string content = read_whole_file(path);
  WarmState warm = unpack_warm_state(content, study, path);
  if (bytes != nullptr) *bytes = std::move(content);
  return warm;
}

std::string set_aside(const std::string& path, const std::string& why) {
  std::error_code error;
  fs::rename(path, path + ".damaged", error);
  if (error) throw WriteError(fmt::format("{}: cannot be renamed: {}", path, error.message()));
  return fmt::format("{}; set aside as {}.damaged, it will be made again", why, path);
}

}  // namespace drumsweep
