/// Small helpers around the HDF5 library, for the files of this folder only.
#pragma once

#include <hdf5.h>

#include <cstdint>
#include <stdexcept>
#include <string>

namespace drumsweep::hdf5 {

/// Closes an HDF5 object whatever its type.
struct Handle {
  hid_t id;
  herr_t (*close)(hid_t);
  Handle(hid_t i, herr_t (*c)(hid_t), const std::string& what) : id(i), close(c) {
    if (id < 0) throw std::runtime_error("HDF5: " + what + " failed");
  }
  ~Handle() {
    if (id >= 0) close(id);
  }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  operator hid_t() const { return id; }
};

inline void check(herr_t status, const char* what) {
  if (status < 0) throw std::runtime_error(std::string("HDF5: ") + what + " failed");
}

/// The library prints its own error stack on standard error unless told not to; our exceptions say it once.
inline void silence() { H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr); }

/// For a file in memory, of the format since 1.8: it has checksums on everything that is not data.
struct MemoryAccess : Handle {
  MemoryAccess() : Handle(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, "property list") {
    check(H5Pset_fapl_core(id, std::size_t{1} << 20, false), "core driver");
    check(H5Pset_libver_bounds(id, H5F_LIBVER_V18, H5F_LIBVER_V18), "format version");
  }
};

/// A new file in memory, without times: equal content, equal bytes.
struct MemoryFile {
  MemoryAccess access;
  Handle creation, file;
  MemoryFile();
  /// All bytes, behind `room` bytes for a user block.
  std::string image(std::size_t room) const;
};

void write_number(hid_t object, const std::string& name, std::uint32_t value);

/// CRC-32 over names, types, shapes and values of all that is below an object, its attributes included but for the one
/// named `content_crc32`.
std::uint32_t content_crc(hid_t object);

}  // namespace drumsweep::hdf5
