/// HDF5 files as immutable images: built in memory, sealed with a checksum, written in one piece; verified before they
/// are opened.
///
/// A sealed file begins with a user block of 512 bytes (part of the HDF5 format, skipped by every reader): one line of
/// text with kind, layout, program version, length and CRC-32 of the rest. So h5dump, h5py and HDFView open it, and a
/// damaged or foreign file is refused before the HDF5 library sees a byte of it.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

namespace drumsweep {

/// A stored file that cannot be used: damaged, another kind, or another layout; says which and what to do.
struct StoreError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Of the library that is loaded: "1.10.8".
std::string hdf5_version();

class Hdf5Writer {
 public:
  Hdf5Writer();
  ~Hdf5Writer();
  Hdf5Writer(const Hdf5Writer&) = delete;
  Hdf5Writer& operator=(const Hdf5Writer&) = delete;

  /// Dataset (rows x columns; columns 1: one-dimensional) with unit and description as attributes. Groups in `name` are
  /// made.
  void dataset(const std::string& name, std::span<const double> values, std::size_t columns, const std::string& unit,
               const std::string& about);
  void dataset(const std::string& name, std::span<const float> values, std::size_t columns, const std::string& unit,
               const std::string& about);
  void dataset(const std::string& name, std::span<const std::uint32_t> values, std::size_t columns,
               const std::string& unit, const std::string& about);
  void dataset(const std::string& name, std::span<const std::uint8_t> values, std::size_t columns,
               const std::string& unit, const std::string& about);
  void dataset(const std::string& name, std::span<const std::int64_t> values, std::size_t columns,
               const std::string& unit, const std::string& about);
  /// Attributes of the root group.
  void attribute(const std::string& name, double value);
  void attribute(const std::string& name, std::int64_t value);
  void attribute(const std::string& name, const std::string& value);

  /// The whole file, sealed. @param kind  one word  @param layout  version of the layout of this kind
  std::string seal(const std::string& kind, int layout);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

class Hdf5Reader {
 public:
  /// @param source  names the file in messages
  /// @throws StoreError when the bytes are not a whole, undamaged file of this kind and layout
  Hdf5Reader(const std::string& bytes, const std::string& kind, int layout, const std::string& source);
  ~Hdf5Reader();
  Hdf5Reader(const Hdf5Reader&) = delete;
  Hdf5Reader& operator=(const Hdf5Reader&) = delete;

  std::vector<double> doubles(const std::string& name) const;
  std::vector<float> floats(const std::string& name) const;
  std::vector<std::uint32_t> uint32s(const std::string& name) const;
  std::vector<std::uint8_t> uint8s(const std::string& name) const;
  std::vector<std::int64_t> int64s(const std::string& name) const;
  double real(const std::string& attribute) const;
  std::int64_t integer(const std::string& attribute) const;
  std::string text(const std::string& attribute) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace drumsweep
