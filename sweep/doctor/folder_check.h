/// Is a folder fit to hold a sweep's results? Tried out with files of its own, which are gone afterwards.
#pragma once

#include <memory>
#include <string>

#include "sweep/doctor/finding.h"
#include "sweep/store/output_lock.h"

namespace drumsweep {

class FolderCheck {
 public:
  /// Tries the folder, or what there is of its path: file system, free space, whether a file can be written, how long a
  /// durable write takes (300 kB, as a recording), whether locks work.
  explicit FolderCheck(const std::string& folder);
  ~FolderCheck();
  FolderCheck(const FolderCheck&) = delete;
  FolderCheck& operator=(const FolderCheck&) = delete;

  const std::vector<Finding>& findings() const { return findings_; }
  /// False when nothing can be written there; then there is nothing for other ranks to look at.
  bool writable() const { return write_ms_ > 0; }
  double write_ms() const { return write_ms_; }  ///< of a durable write, median; 0 when it fails

  /// While this object lives: a small file, what is in it, and a file that is locked.
  std::string probe() const { return base_ + ".probe"; }
  std::string lock() const { return base_ + ".lock"; }
  const std::string& token() const { return token_; }
  bool locked() const { return lock_ && lock_->held(); }

 private:
  void look_at_space(const std::string& folder);
  void try_writing();
  void try_locking();

  std::vector<Finding> findings_;
  std::string base_, token_;
  double write_ms_ = 0;
  std::unique_ptr<OutputLock> lock_;
};

}  // namespace drumsweep
