#include "core/io/hdf5_image.h"

#include <fmt/format.h>
#include <hdf5.h>
#include <zlib.h>

#include <cstdio>
#include <cstring>

namespace drumsweep {
namespace {

constexpr std::size_t user_block = 512;

/// Closes an HDF5 object whatever its type.
struct Handle {
  hid_t id;
  herr_t (*close)(hid_t);
  Handle(hid_t i, herr_t (*c)(hid_t), const char* what) : id(i), close(c) {
    if (id < 0) throw std::runtime_error(std::string("HDF5: ") + what + " failed");
  }
  ~Handle() {
    if (id >= 0) close(id);
  }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  operator hid_t() const { return id; }
};

void check(herr_t status, const char* what) {
  if (status < 0) throw std::runtime_error(std::string("HDF5: ") + what + " failed");
}

/// The library prints its own error stack on standard error unless told not to; our exceptions say it once.
void silence() { H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr); }

template <class T>
hid_t type_of();
template <>
hid_t type_of<double>() {
  return H5T_NATIVE_DOUBLE;
}
template <>
hid_t type_of<float>() {
  return H5T_NATIVE_FLOAT;
}
template <>
hid_t type_of<std::uint32_t>() {
  return H5T_NATIVE_UINT32;
}
template <>
hid_t type_of<std::uint8_t>() {
  return H5T_NATIVE_UINT8;
}
template <>
hid_t type_of<std::int64_t>() {
  return H5T_NATIVE_INT64;
}

void write_text(hid_t object, const std::string& name, const std::string& value) {
  const Handle type(H5Tcopy(H5T_C_S1), H5Tclose, "string type");
  check(H5Tset_size(type, std::max<std::size_t>(1, value.size())), "string size");
  check(H5Tset_cset(type, H5T_CSET_UTF8), "string encoding");
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose, "dataspace");
  const Handle attribute(H5Acreate2(object, name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose,
                         "attribute");
  check(H5Awrite(attribute, type, value.empty() ? "\0" : value.data()), "attribute write");
}

template <class T>
void write_number(hid_t object, const std::string& name, T value) {
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose, "dataspace");
  const Handle attribute(H5Acreate2(object, name.c_str(), type_of<T>(), space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose,
                         "attribute");
  check(H5Awrite(attribute, type_of<T>(), &value), "attribute write");
}

constexpr std::size_t longest_attribute = 60000;  // HDF5 allows 64 kB

template <class T>
void write_dataset(hid_t file, const std::string& name, std::span<const T> values, std::size_t columns,
                   const std::string& unit, const std::string& about) {
  const hsize_t size[2] = {values.size() / columns, columns};
  const Handle space(H5Screate_simple(columns == 1 ? 1 : 2, size, nullptr), H5Sclose, "dataspace");
  const Handle links(H5Pcreate(H5P_LINK_CREATE), H5Pclose, "property list");
  check(H5Pset_create_intermediate_group(links, 1), "intermediate groups");
  const Handle options(H5Pcreate(H5P_DATASET_CREATE), H5Pclose, "property list");
  check(H5Pset_obj_track_times(options, false), "track times");  // equal content, equal bytes
  const Handle data(H5Dcreate2(file, name.c_str(), type_of<T>(), space, links, options, H5P_DEFAULT), H5Dclose,
                    "dataset");
  if (!values.empty())
    check(H5Dwrite(data, type_of<T>(), H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), "dataset write");
  write_text(data, "unit", unit);
  write_text(data, "about", about);
}

}  // namespace

struct Hdf5Writer::Impl {
  Handle access, creation, file;
  Impl()
      : access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, "property list"),
        creation(H5Pcreate(H5P_FILE_CREATE), H5Pclose, "property list"),
        file((silence(), H5Pset_fapl_core(access, std::size_t{1} << 20, false), H5Pset_obj_track_times(creation, false),
              H5Fcreate("image-in-memory", H5F_ACC_TRUNC, creation, access)),
             H5Fclose, "file image") {}
};

std::string hdf5_version() {
  unsigned major = 0, minor = 0, release = 0;
  H5get_libversion(&major, &minor, &release);
  return fmt::format("{}.{}.{}", major, minor, release);
}

Hdf5Writer::Hdf5Writer() : impl_(std::make_unique<Impl>()) {}
Hdf5Writer::~Hdf5Writer() = default;

void Hdf5Writer::dataset(const std::string& name, std::span<const double> values, std::size_t columns,
                         const std::string& unit, const std::string& about) {
  write_dataset(impl_->file, name, values, columns, unit, about);
}
void Hdf5Writer::dataset(const std::string& name, std::span<const float> values, std::size_t columns,
                         const std::string& unit, const std::string& about) {
  write_dataset(impl_->file, name, values, columns, unit, about);
}
void Hdf5Writer::dataset(const std::string& name, std::span<const std::uint32_t> values, std::size_t columns,
                         const std::string& unit, const std::string& about) {
  write_dataset(impl_->file, name, values, columns, unit, about);
}
void Hdf5Writer::dataset(const std::string& name, std::span<const std::uint8_t> values, std::size_t columns,
                         const std::string& unit, const std::string& about) {
  write_dataset(impl_->file, name, values, columns, unit, about);
}
void Hdf5Writer::dataset(const std::string& name, std::span<const std::int64_t> values, std::size_t columns,
                         const std::string& unit, const std::string& about) {
  write_dataset(impl_->file, name, values, columns, unit, about);
}
void Hdf5Writer::attribute(const std::string& name, double value) { write_number(impl_->file, name, value); }
void Hdf5Writer::attribute(const std::string& name, std::int64_t value) { write_number(impl_->file, name, value); }
void Hdf5Writer::attribute(const std::string& name, const std::string& value) {
  if (value.size() > longest_attribute)
    throw std::length_error(
        fmt::format("HDF5 attribute {}: {} bytes, at most {} fit", name, value.size(), longest_attribute));
  write_text(impl_->file, name, value);
}

std::string Hdf5Writer::seal(const std::string& kind, int layout) {
  check(H5Fflush(impl_->file, H5F_SCOPE_LOCAL), "flush");
  const ssize_t size = H5Fget_file_image(impl_->file, nullptr, 0);
  if (size <= 0) throw std::runtime_error("HDF5: file image failed");
  std::string bytes(user_block + static_cast<std::size_t>(size), '\n');
  if (H5Fget_file_image(impl_->file, bytes.data() + user_block, static_cast<std::size_t>(size)) != size)
    throw std::runtime_error("HDF5: file image failed");
  const auto crc = crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()) + user_block, bytes.size() - user_block);
  const std::string head = fmt::format("drumsweep {} layout {} version {} bytes {} crc32 {:08x}\n", kind, layout,
                                       DRUMSWEEP_VERSION, bytes.size() - user_block, crc);
  std::memcpy(bytes.data(), head.data(), head.size());
  return bytes;
}

struct Hdf5Reader::Impl {
  std::string source;
  Handle access, file;
  Impl(const char* image, std::size_t size, const std::string& name)
      : source(name),
        access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, "property list"),
        file((silence(), H5Pset_fapl_core(access, std::size_t{1} << 20, false),
              H5Pset_file_image(access, const_cast<char*>(image), size),
              H5Fopen("image-in-memory", H5F_ACC_RDONLY, access)),
             H5Fclose, "opening the file image") {}

  template <class T>
  std::vector<T> read(const std::string& name) const {
    const Handle data(H5Dopen2(file, name.c_str(), H5P_DEFAULT), H5Dclose, (source + ": dataset " + name).c_str());
    const Handle space(H5Dget_space(data), H5Sclose, "dataspace");
    std::vector<T> values(static_cast<std::size_t>(std::max<hssize_t>(0, H5Sget_simple_extent_npoints(space))));
    if (!values.empty())
      check(H5Dread(data, type_of<T>(), H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), "dataset read");
    return values;
  }
  template <class T>
  T number(const std::string& name) const {
    const Handle attribute(H5Aopen(file, name.c_str(), H5P_DEFAULT), H5Aclose,
                           (source + ": attribute " + name).c_str());
    T value{};
    check(H5Aread(attribute, type_of<T>(), &value), "attribute read");
    return value;
  }
};

Hdf5Reader::Hdf5Reader(const std::string& bytes, const std::string& kind, int layout, const std::string& source) {
  char found_kind[64] = "", version[64] = "";
  int found_layout = 0;
  unsigned long long size = 0;
  unsigned int crc = 0;
  const std::string head = bytes.substr(0, std::min(bytes.size(), bytes.find('\n')));
  if (head.rfind("drumsweep ", 0) != 0 ||
      std::sscanf(head.c_str(), "drumsweep %63s layout %d version %63s bytes %llu crc32 %x", found_kind, &found_layout,
                  version, &size, &crc) != 5)
    throw StoreError(source + ": is not a drumsweep file (its first line is not one that this program writes)");
  if (kind != found_kind) throw StoreError(fmt::format("{}: holds a {}, not a {}", source, found_kind, kind));
  if (layout != found_layout)
    throw StoreError(fmt::format("{}: layout {} of drumsweep {}; this is drumsweep {}, which reads layout {}", source,
                                 found_layout, version, DRUMSWEEP_VERSION, layout));
  if (bytes.size() != user_block + size)
    throw StoreError(
        fmt::format("{}: damaged: {} bytes where {} were written", source, bytes.size(), user_block + size));
  if (crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()) + user_block, size) != crc)
    throw StoreError(source + ": damaged: its checksum does not match");
  impl_ = std::make_unique<Impl>(bytes.data() + user_block, size, source);
}
Hdf5Reader::~Hdf5Reader() = default;

std::vector<double> Hdf5Reader::doubles(const std::string& name) const { return impl_->read<double>(name); }
std::vector<float> Hdf5Reader::floats(const std::string& name) const { return impl_->read<float>(name); }
std::vector<std::uint32_t> Hdf5Reader::uint32s(const std::string& name) const {
  return impl_->read<std::uint32_t>(name);
}
std::vector<std::uint8_t> Hdf5Reader::uint8s(const std::string& name) const { return impl_->read<std::uint8_t>(name); }
std::vector<std::int64_t> Hdf5Reader::int64s(const std::string& name) const { return impl_->read<std::int64_t>(name); }
double Hdf5Reader::real(const std::string& attribute) const { return impl_->number<double>(attribute); }
std::int64_t Hdf5Reader::integer(const std::string& attribute) const { return impl_->number<std::int64_t>(attribute); }

std::string Hdf5Reader::text(const std::string& name) const {
  const Handle attribute(H5Aopen(impl_->file, name.c_str(), H5P_DEFAULT), H5Aclose,
                         (impl_->source + ": attribute " + name).c_str());
  const Handle type(H5Aget_type(attribute), H5Tclose, "attribute type");
  std::string value(H5Tget_size(type), '\0');
  check(H5Aread(attribute, type, value.data()), "attribute read");
  return value == std::string(1, '\0') ? "" : value;
}

}  // namespace drumsweep
