/// The recordings of a folder, wherever they lie: loose (designs/ID.h5) or packed (designs/pack_NNNN.h5, about a hundred
/// each), and how loose ones get packed.
///
/// Packing never has a moment at which a recording is in no file: a pack is written durably, read again and compared
/// with the loose files, and only then are these removed. A crash in between leaves a recording twice, which is
/// harmless: the loose one is read, and the next packing removes it. A damaged pack is taken apart: what is still good
/// becomes loose again, the rest is simulated anew, and the pack is set aside.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "sweep/store/store.h"

namespace drumsweep {

/// Identifies the bytes of a recording, and says that they are undamaged when it comes from verify().
struct Checksum {
  std::uint32_t crc = 0;
  std::uint64_t bytes = 0;
  bool operator==(const Checksum&) const = default;
};

struct PackingRules {
  std::size_t most_loose = 200;               ///< packing begins when more than these are loose ...
  std::size_t per_pack = 100;                 ///< ... and takes this many at a time, in the order of their names ...
  std::uint64_t bytes_per_pack = 64u << 20u;  ///< ... or fewer, up to this size: it is built in memory
  std::size_t most_packs = 10;                ///< at a time: about a second during which a run does nothing else
};

/// What is there, from one look at the folder's names and at the first kilobytes of each pack. Cheap to make: `status`
/// makes one. A run keeps one and tells it what is new.
class RecordingIndex {
 public:
  explicit RecordingIndex(OutputPaths paths);

  bool has_recording(const std::string& id) const { return loose_.count(id) > 0 || packed_.count(id) > 0; }
  bool has_failure(const std::string& id) const { return failed_.count(id) > 0; }
  std::size_t num_loose() const { return loose_.size(); }
  std::size_t num_packs() const { return packs_.size(); }
  /// Path of the file that holds the recording; empty when there is none.
  std::string file_of(const std::string& id) const;

  /// Looks for this design again: it may have ended.
  void look_again(const std::string& id);

  /// Reads every byte of the recording, of a pack once. @throws StoreError (damaged)
  Checksum verify(const std::string& id);
  /// The checksum of a recording that has been verified.
  std::optional<Checksum> verified(const std::string& id) const;

  /// What is stored of a design. @throws StoreError (damaged), MismatchError (of another study or design)
  StoredDesign read(const Study& study, const PlannedDesign& design);

  /// After a StoreError: renames the damaged file to *.damaged, what a damaged pack still has becomes loose.
  /// @return the sentence to say. @throws WriteError
  std::string set_aside(const std::string& id, const std::string& why);

  /// Packs until at most `most_loose` are loose, or `most_packs` were made. @return what was done, in sentences. @throws WriteError
  std::vector<std::string> pack(const PackingRules& rules = {});

  // The steps of pack(), in this order.

  /// Writes a new pack with these loose recordings. @throws StoreError naming a damaged one, WriteError
  std::string write_pack(const std::vector<std::string>& ids);
  /// True when the pack, read again, is undamaged and holds the very bytes of these loose recordings.
  bool holds(const std::string& pack, const std::vector<std::string>& ids);
  /// Removes loose recordings that a pack holds. @throws WriteError
  void remove_loose(const std::vector<std::string>& ids);

 private:
  struct Place {
    std::string pack;  ///< path
    Checksum checksum;
  };
  void list();
  void list_if_gone(const std::string& id);
  std::string take_apart(const std::string& pack, const std::string& why);

  OutputPaths paths_;
  std::set<std::string> loose_, failed_;
  std::map<std::string, Place> packed_;
  std::map<std::string, std::string> packs_;  ///< path -> what is wrong with its index, empty when nothing is
  std::set<std::string> intact_;              ///< packs that were read and are undamaged
  std::map<std::string, Checksum> verified_;
};

}  // namespace drumsweep
