/// HDF5 files as immutable images: built in memory, sealed with a checksum, written in one piece; verified before they
/// are opened.
///
/// A sealed file begins with a user block of 512 bytes (part of the HDF5 format, skipped by every reader): one line of
/// text with kind, layout, program version, length and CRC-32 of the rest. So h5dump, h5py and HDFView open it, and a
/// damaged or foreign file is refused before the HDF5 library sees a byte of it.
#pragma once

#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace drumsweep {

/// A stored file that cannot be used: damaged, another kind, or another layout; says which and what to do.
struct StoreError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Of the library that is loaded: "1.10.8".
std::string hdf5_version();
/// What a sealed file says of itself in its first line.
struct Seal {
  std::string kind, version;
  int layout = 0;
  std::uint64_t bytes = 0;  ///< after the user block
  std::uint32_t crc = 0;    ///< of these
};
/// Checks length and checksum, not the content. @throws StoreError
Seal verify_seal(std::string_view bytes, const std::string& source);

class Hdf5Writer {
 public:
  Hdf5Writer();
  ~Hdf5Writer();
  Hdf5Writer(const Hdf5Writer&) = delete;
  Hdf5Writer& operator=(const Hdf5Writer&) = delete;

  /// Dataset (rows x columns; columns 1: one-dimensional) with its unit and meaning as attributes. Groups in `name` are
  /// made. @param frames  above 0: one more dimension of that size in front, moments of a time series as H5MD has them
  template <class T>  // double, float, std::uint32_t, std::uint8_t, std::int64_t
  void dataset(const std::string& name, const std::vector<T>& values, std::size_t columns, const std::string& unit,
               const std::string& long_name, std::size_t frames = 0);
  /// Text of fixed length, UTF-8.
  void texts(const std::string& name, const std::vector<std::string>& values, const std::string& long_name);
  /// A second name for an object that is there.
  void link(const std::string& name, const std::string& existing);
  /// Attributes of the root, or of a group that is made if need be.
  void attribute(const std::string& name, double value, const std::string& group = "/");
  void attribute(const std::string& name, std::int64_t value, const std::string& group = "/");
  void attribute(const std::string& name, const std::string& value, const std::string& group = "/");
  void attribute(const std::string& name, const std::vector<std::int64_t>& values, const std::string& group = "/");
  void attribute(const std::string& name, const std::vector<std::string>& values, const std::string& group = "/");

  /// The whole file, sealed. @param kind  one word  @param layout  version of the layout of this kind
  std::string seal(const std::string& kind, int layout);
  /// The whole file as it is, for other programs: nothing here reads it again.
  std::string plain() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

class Hdf5Reader {
 public:
  /// @param source  names the file in messages
  /// @throws StoreError when the bytes are not a whole, undamaged file of this kind and layout
  Hdf5Reader(const std::string& bytes, const std::string& kind, int layout, const std::string& source);
  /// One recording of a pack (hdf5_pack.h). @throws StoreError when it is not there or is damaged
  Hdf5Reader(const std::string& pack_path, const std::string& name);
  ~Hdf5Reader();
  Hdf5Reader(const Hdf5Reader&) = delete;
  Hdf5Reader& operator=(const Hdf5Reader&) = delete;

  std::vector<double> doubles(const std::string& name) const;
  std::vector<float> floats(const std::string& name) const;
  std::vector<std::uint32_t> uint32s(const std::string& name) const;
  std::vector<std::uint8_t> uint8s(const std::string& name) const;
  std::vector<std::int64_t> int64s(const std::string& name) const;
  std::vector<std::string> texts(const std::string& name) const;
  double real(const std::string& attribute) const;
  std::int64_t integer(const std::string& attribute) const;
  std::string text(const std::string& attribute) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace drumsweep
