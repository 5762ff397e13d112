#include "sweep/store/recordings.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <system_error>

#include "core/io/durable_file.h"
#include "core/io/hdf5_pack.h"

namespace drumsweep {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t id_length = 10;

bool is_id(const std::string& text) {
  return text.size() == id_length && text.find_first_not_of("0123456789abcdef") == std::string::npos;
}

bool is_pack(const std::string& name) { return name.starts_with("pack_") && name.ends_with(".h5"); }

}  // namespace

RecordingIndex::RecordingIndex(OutputPaths paths) : paths_(std::move(paths)) { list(); }

void RecordingIndex::list() {
  loose_.clear();
  failed_.clear();
  packed_.clear();
  packs_.clear();
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(paths_.designs(), error)) {
    const std::string name = entry.path().filename().string(), stem = name.substr(0, name.find('.'));
    if (is_pack(name)) packs_.emplace(paths_.designs() + "/" + name, "");
    if (!is_id(stem)) continue;
    if (name == stem + ".h5") loose_.insert(stem);
    if (name == stem + ".failed") failed_.insert(stem);
  }
  for (auto& [path, trouble] : packs_) {
    try {
      for (const PackedImage& image : read_pack_index(path)) packed_[image.name] = {path, {image.crc, image.bytes}};
    } catch (const StoreError& damaged) {
      // Its groups may still be readable; reading any of them will tell that the pack is damaged.
      trouble = damaged.what();
      for (const std::string& name : names_in_pack(path))
        if (is_id(name)) packed_[name] = {path, {}};
    }
  }
}

/// Another process may have packed it since the folder was looked at.
void RecordingIndex::list_if_gone(const std::string& id) {
  std::error_code error;
  if (loose_.count(id) > 0 && !fs::exists(paths_.recording(id), error)) list();
}

std::string RecordingIndex::file_of(const std::string& id) const {
  if (loose_.count(id) > 0) return paths_.recording(id);
  const auto place = packed_.find(id);
  return place == packed_.end() ? "" : place->second.pack;
}

void RecordingIndex::look_again(const std::string& id) {
  std::error_code error;
  if (fs::exists(paths_.recording(id), error)) {
    loose_.insert(id);
    verified_.erase(id);
  }
  if (fs::exists(paths_.failure(id), error)) failed_.insert(id);
}

Checksum RecordingIndex::verify(const std::string& id) {
  if (const auto known = verified(id)) return *known;
  list_if_gone(id);
  Checksum checksum;
  if (loose_.count(id) > 0) {
    const std::string path = paths_.recording(id);
    const Seal seal = verify_seal(read_whole_file(path), path);
    checksum = {seal.crc, seal.bytes};
  } else {
    const auto found = packed_.find(id);
    if (found == packed_.end()) throw StoreError(paths_.recording(id) + ": is gone");
    const Place& place = found->second;
    if (const std::string& trouble = packs_.at(place.pack); !trouble.empty()) throw StoreError(trouble);
    if (intact_.count(place.pack) == 0) verify_pack(place.pack);
    intact_.insert(place.pack);
    checksum = place.checksum;
  }
  return verified_[id] = checksum;
}

std::optional<Checksum> RecordingIndex::verified(const std::string& id) const {
  const auto found = verified_.find(id);
  return found == verified_.end() ? std::nullopt : std::optional(found->second);
}

StoredDesign RecordingIndex::read(const Study& study, const PlannedDesign& design) {
  list_if_gone(design.id);
  StoredDesign stored;
  if (loose_.count(design.id) > 0) {
    const std::string path = paths_.recording(design.id), bytes = read_whole_file(path);
    stored.recording = unpack_recording(bytes, study, design.id, design.values, path);
    const Seal seal = verify_seal(bytes, path);
    verified_[design.id] = {seal.crc, seal.bytes};
  } else if (const auto place = packed_.find(design.id); place != packed_.end()) {
    const Hdf5Reader file(place->second.pack, design.id);
    stored.recording = read_recording(file, study, design.id, design.values, place->second.pack + ": " + design.id);
  } else if (has_failure(design.id)) {
    stored.failure = read_failure(paths_, design.id);
  }
  return stored;
}

std::string RecordingIndex::set_aside(const std::string& id, const std::string& why) {
  verified_.erase(id);
  if (loose_.erase(id) > 0) return drumsweep::set_aside(paths_.recording(id), why);
  if (const auto place = packed_.find(id); place != packed_.end()) {
    const std::string pack = place->second.pack;
    return take_apart(pack, why);
  }
  failed_.erase(id);
  return drumsweep::set_aside(paths_.failure(id), why);
}

std::string RecordingIndex::take_apart(const std::string& pack, const std::string& why) {
  std::size_t saved = 0, lost = 0;
  for (const auto& [id, place] : packed_) {
    if (place.pack != pack || loose_.count(id) > 0) continue;
    try {
      const Hdf5Reader file(pack, id);
      write_durably(paths_.recording(id), repack_recording(file, pack + ": " + id));
      ++saved;
    } catch (const StoreError&) {
      ++lost;
    } catch (const MismatchError&) {
      ++lost;
    }
  }
  const std::string said = drumsweep::set_aside(pack, why);
  verified_.clear();
  list();
  return fmt::format("{}; {} of its recordings are good and now files of their own, {} are lost", said, saved, lost);
}

std::vector<std::string> RecordingIndex::pack(const PackingRules& rules) {
  std::vector<std::string> said;
  if (loose_.size() <= rules.most_loose) return said;

  // A crash while packing has left these twice.
  std::map<std::string, std::vector<std::string>> twice;
  for (const std::string& id : loose_)
    if (const auto place = packed_.find(id); place != packed_.end()) twice[place->second.pack].push_back(id);
  for (const auto& [pack, ids] : twice)
    if (holds(pack, ids)) remove_loose(ids);

  std::size_t num_packed = 0, num_packs_made = 0;
  for (; loose_.size() > rules.most_loose && num_packs_made < rules.most_packs; ++num_packs_made) {
    std::vector<std::string> ids;
    std::uint64_t bytes = 0;
    std::error_code error;
    for (auto id = loose_.begin(); id != loose_.end() && ids.size() < rules.per_pack; ++id) {
      bytes += fs::file_size(paths_.recording(*id), error);
      if (!ids.empty() && bytes > rules.bytes_per_pack) break;
      ids.push_back(*id);
    }
    // A damaged one stays out of the pack.
    for (std::size_t i = 0; i < ids.size();) {
      try {
        verified_.erase(ids[i]);
        verify(ids[i]);
        ++i;
      } catch (const StoreError& damaged) {
        said.push_back(set_aside(ids[i], damaged.what()));
        ids.erase(ids.begin() + static_cast<std::ptrdiff_t>(i));
      }
    }
    if (ids.empty()) continue;
    const std::string pack = write_pack(ids);
    if (!holds(pack, ids)) {
      said.push_back(drumsweep::set_aside(pack, pack + ": reads otherwise than it was written"));
      list();
      return said;
    }
    remove_loose(ids);
    num_packed += ids.size();
  }
  if (num_packed > 0) said.push_back(fmt::format("{} recordings packed into {} files", num_packed, num_packs_made));
  return said;
}

std::string RecordingIndex::write_pack(const std::vector<std::string>& ids) {
  std::vector<std::pair<std::string, std::string>> images;
  for (const std::string& id : ids) images.emplace_back(id, read_whole_file(paths_.recording(id)));
  std::string path;
  std::error_code error;
  for (int number = static_cast<int>(packs_.size()) + 1; path.empty(); ++number) {
    path = fmt::format("{}/pack_{:04}.h5", paths_.designs(), number);
    if (fs::exists(path, error) || fs::exists(path + ".damaged", error)) path.clear();
  }
  write_durably(path, make_pack(images));
  packs_.emplace(path, "");
  return path;
}

bool RecordingIndex::holds(const std::string& pack, const std::vector<std::string>& ids) {
  try {
    verify_pack(pack);
    std::map<std::string, Checksum> there;
    for (const PackedImage& image : read_pack_index(pack)) there[image.name] = {image.crc, image.bytes};
    for (const std::string& id : ids) {
      const Hdf5Reader readable(pack, id);
      const std::string path = paths_.recording(id);
      const Seal loose = verify_seal(read_whole_file(path), path);
      const auto found = there.find(id);
      if (found == there.end() || found->second != Checksum{loose.crc, loose.bytes}) return false;
    }
    for (const std::string& id : ids) packed_[id] = {pack, there[id]};
    intact_.insert(pack);
    return true;
  } catch (const StoreError&) {
    return false;
  }
}

void RecordingIndex::remove_loose(const std::vector<std::string>& ids) {
  for (const std::string& id : ids) {
    const std::string path = paths_.recording(id);
    if (::unlink(path.c_str()) != 0 && errno != ENOENT)
      throw WriteError(fmt::format("{}: cannot be removed: {}", path, std::strerror(errno)));
    loose_.erase(id);
  }
  sync_folder(paths_.designs());
}

}  // namespace drumsweep
