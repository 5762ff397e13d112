#include "core/io/hdf5_image.h"

#include <fmt/format.h>
#include <hdf5.h>
#include <zlib.h>

#include <algorithm>
#include <cstdio>
#include <cstring>

#include "core/io/hdf5_handle.h"

namespace drumsweep {

using hdf5::check;
using hdf5::Handle;
using hdf5::MemoryAccess;
using hdf5::MemoryFile;

namespace {

constexpr std::size_t user_block = 512;
constexpr std::size_t longest_attribute = 60000;  // HDF5 allows 64 kB

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

/// Fixed length; ASCII where the text is, as the units module of H5MD asks for. A single text fills its length, of
/// several the shorter ones end with a zero.
hid_t text_type(std::size_t length, bool ascii, bool single) {
  const hid_t type = H5Tcopy(H5T_C_S1);
  check(H5Tset_size(type, std::max<std::size_t>(1, length)), "string size");
  check(H5Tset_strpad(type, single ? H5T_STR_NULLPAD : H5T_STR_NULLTERM), "string padding");
  check(H5Tset_cset(type, ascii ? H5T_CSET_ASCII : H5T_CSET_UTF8), "string encoding");
  return type;
}

bool is_ascii(const std::string& text) {
  return std::all_of(text.begin(), text.end(), [](char c) { return static_cast<unsigned char>(c) < 0x80; });
}

/// Texts behind one another, each padded with zeros to one more than the longest.
struct PaddedTexts {
  std::size_t length = 1;
  bool ascii = true;
  std::string bytes;
  explicit PaddedTexts(const std::vector<std::string>& texts) {
    for (const std::string& text : texts) {
      length = std::max(length, text.size() + 1);
      ascii = ascii && is_ascii(text);
    }
    for (const std::string& text : texts) bytes += text + std::string(length - text.size(), '\0');
  }
};

void write_attribute(hid_t object, const std::string& name, hid_t type, hid_t space, const void* value) {
  const Handle attribute(H5Acreate2(object, name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose,
                         "attribute " + name);
  check(H5Awrite(attribute, type, value), "attribute write");
}

void write_text(hid_t object, const std::string& name, const std::string& value) {
  const Handle type(text_type(value.size(), is_ascii(value), true), H5Tclose, "string type");
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose, "dataspace");
  write_attribute(object, name, type, space, value.empty() ? "\0" : value.data());
}

template <class T>
void write_scalar(hid_t object, const std::string& name, T value) {
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose, "dataspace");
  write_attribute(object, name, type_of<T>(), space, &value);
}

/// Makes the groups of a path, all of it or up to its last part. Not left to the library: groups that it makes on the
/// way carry the time.
void make_groups(hid_t file, const std::string& path, bool last_too) {
  const Handle options(H5Pcreate(H5P_GROUP_CREATE), H5Pclose, "property list");
  check(H5Pset_obj_track_times(options, false), "track times");
  for (std::size_t end = path.find('/', 1); end != std::string::npos || last_too; end = path.find('/', end + 1)) {
    const std::string part = path.substr(0, end);
    if (H5Lexists(file, part.c_str(), H5P_DEFAULT) <= 0)
      Handle(H5Gcreate2(file, part.c_str(), H5P_DEFAULT, options, H5P_DEFAULT), H5Gclose, "group " + part);
    if (end == std::string::npos) break;
  }
}

/// New dataset; groups in its name are made.
hid_t new_dataset(hid_t file, const std::string& name, hid_t type, const std::vector<hsize_t>& shape) {
  make_groups(file, name, false);
  const Handle space(H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr), H5Sclose, "dataspace");
  const Handle options(H5Pcreate(H5P_DATASET_CREATE), H5Pclose, "property list");
  check(H5Pset_obj_track_times(options, false), "track times");
  return H5Dcreate2(file, name.c_str(), type, space, H5P_DEFAULT, options, H5P_DEFAULT);
}

/// The group of that name, made if need be.
hid_t group_named(hid_t file, const std::string& name) {
  if (name != "/") make_groups(file, name, true);
  return H5Gopen2(file, name.c_str(), H5P_DEFAULT);
}

}  // namespace

namespace hdf5 {

MemoryFile::MemoryFile()
    : creation(H5Pcreate(H5P_FILE_CREATE), H5Pclose, "property list"),
      file((silence(), H5Pset_obj_track_times(creation, false),
            H5Fcreate("image-in-memory", H5F_ACC_TRUNC, creation, access)),
           H5Fclose, "file image") {}

std::string MemoryFile::image(std::size_t room) const {
  check(H5Fflush(file, H5F_SCOPE_LOCAL), "flush");
  // Straight from the driver's memory: H5Fget_file_image() of HDF5 1.10 clears a flag in the superblock without
  // correcting the checksum over it, and the library then refuses the image.
  const ssize_t size = H5Fget_file_image(file, nullptr, 0);
  void* place = nullptr;
  check(H5Fget_vfd_handle(file, access, &place), "file image");
  if (size <= 0 || place == nullptr) throw std::runtime_error("HDF5: file image failed");
  std::string bytes(room, '\n');
  return bytes.append(*static_cast<const char**>(place), static_cast<std::size_t>(size));
}

void write_number(hid_t object, const std::string& name, std::uint32_t value) {
  write_scalar<std::uint32_t>(object, name, value);
}

}  // namespace hdf5

Seal verify_seal(std::string_view bytes, const std::string& source) {
  char kind[64] = "", version[64] = "";
  unsigned long long size = 0;
  unsigned int crc = 0;
  Seal seal;
  const std::string head(bytes.substr(0, std::min({bytes.size(), bytes.find('\n'), user_block})));
  if (head.rfind("drumsweep ", 0) != 0 ||
      std::sscanf(head.c_str(), "drumsweep %63s layout %d version %63s bytes %llu crc32 %x", kind, &seal.layout,
                  version, &size, &crc) != 5)
    throw StoreError(source + ": is not a drumsweep file (its first line is not one that this program writes)");
  if (bytes.size() != user_block + size)
    throw StoreError(
        fmt::format("{}: damaged: {} bytes where {} were written", source, bytes.size(), user_block + size));
  if (crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()) + user_block, size) != crc)
    throw StoreError(source + ": damaged: its checksum does not match");
  seal.kind = kind;
  seal.version = version;
  seal.bytes = size;
  seal.crc = crc;
  return seal;
}

struct Hdf5Writer::Impl {
  MemoryFile memory;
  hid_t file = memory.file;
};

std::string hdf5_version() {
  unsigned major = 0, minor = 0, release = 0;
  H5get_libversion(&major, &minor, &release);
  return fmt::format("{}.{}.{}", major, minor, release);
}

Hdf5Writer::Hdf5Writer() : impl_(std::make_unique<Impl>()) {}
Hdf5Writer::~Hdf5Writer() = default;

template <class T>
void Hdf5Writer::dataset(const std::string& name, const std::vector<T>& values, std::size_t columns,
                         const std::string& unit, const std::string& long_name, std::size_t frames) {
  std::vector<hsize_t> shape = {values.size() / columns / std::max<std::size_t>(1, frames)};
  if (columns > 1) shape.push_back(columns);
  if (frames > 0) shape.insert(shape.begin(), frames);
  const Handle data(new_dataset(impl_->file, name, type_of<T>(), shape), H5Dclose, "dataset " + name);
  if (!values.empty())
    check(H5Dwrite(data, type_of<T>(), H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), "dataset write");
  write_text(data, "unit", unit);
  write_text(data, "long_name", long_name);
}
template void Hdf5Writer::dataset(const std::string&, const std::vector<double>&, std::size_t, const std::string&,
                                  const std::string&, std::size_t);
template void Hdf5Writer::dataset(const std::string&, const std::vector<float>&, std::size_t, const std::string&,
                                  const std::string&, std::size_t);
template void Hdf5Writer::dataset(const std::string&, const std::vector<std::uint32_t>&, std::size_t,
                                  const std::string&, const std::string&, std::size_t);
template void Hdf5Writer::dataset(const std::string&, const std::vector<std::uint8_t>&, std::size_t, const std::string&,
                                  const std::string&, std::size_t);
template void Hdf5Writer::dataset(const std::string&, const std::vector<std::int64_t>&, std::size_t, const std::string&,
                                  const std::string&, std::size_t);

void Hdf5Writer::texts(const std::string& name, const std::vector<std::string>& values, const std::string& long_name) {
  const PaddedTexts padded(values);
  const Handle type(text_type(padded.length, false, false), H5Tclose, "string type");
  const Handle data(new_dataset(impl_->file, name, type, {values.size()}), H5Dclose, "dataset " + name);
  if (!values.empty()) check(H5Dwrite(data, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, padded.bytes.data()), "dataset write");
  write_text(data, "unit", "1");
  write_text(data, "long_name", long_name);
}

void Hdf5Writer::link(const std::string& name, const std::string& existing) {
  make_groups(impl_->file, name, false);
  check(H5Lcreate_hard(impl_->file, existing.c_str(), H5L_SAME_LOC, name.c_str(), H5P_DEFAULT, H5P_DEFAULT),
        "hard link");
}

void Hdf5Writer::attribute(const std::string& name, double value, const std::string& group) {
  write_scalar(Handle(group_named(impl_->file, group), H5Gclose, "group " + group), name, value);
}
void Hdf5Writer::attribute(const std::string& name, std::int64_t value, const std::string& group) {
  write_scalar(Handle(group_named(impl_->file, group), H5Gclose, "group " + group), name, value);
}
void Hdf5Writer::attribute(const std::string& name, const std::string& value, const std::string& group) {
  if (value.size() > longest_attribute)
    throw std::length_error(
        fmt::format("HDF5 attribute {}: {} bytes, at most {} fit", name, value.size(), longest_attribute));
  write_text(Handle(group_named(impl_->file, group), H5Gclose, "group " + group), name, value);
}
void Hdf5Writer::attribute(const std::string& name, const std::vector<std::int64_t>& values, const std::string& group) {
  const Handle object(group_named(impl_->file, group), H5Gclose, "group " + group);
  const hsize_t size = values.size();
  const Handle space(H5Screate_simple(1, &size, nullptr), H5Sclose, "dataspace");
  write_attribute(object, name, H5T_NATIVE_INT64, space, values.data());
}
void Hdf5Writer::attribute(const std::string& name, const std::vector<std::string>& values, const std::string& group) {
  const Handle object(group_named(impl_->file, group), H5Gclose, "group " + group);
  const PaddedTexts padded(values);
  const Handle type(text_type(padded.length, padded.ascii, false), H5Tclose, "string type");
  const hsize_t size = values.size();
  const Handle space(H5Screate_simple(1, &size, nullptr), H5Sclose, "dataspace");
  write_attribute(object, name, type, space, padded.bytes.data());
}

std::string Hdf5Writer::seal(const std::string& kind, int layout) {
  std::string bytes = impl_->memory.image(user_block);
  const auto crc = crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()) + user_block, bytes.size() - user_block);
  const std::string head = fmt::format("drumsweep {} layout {} version {} bytes {} crc32 {:08x}\n", kind, layout,
                                       DRUMSWEEP_VERSION, bytes.size() - user_block, crc);
  std::memcpy(bytes.data(), head.data(), head.size());
  return bytes;
}

std::string Hdf5Writer::plain() const { return impl_->memory.image(0); }

/// A file, or a group in one that is seen as a file.
struct Hdf5Reader::Impl {
  std::string source;
  Handle access, file, root;

  /// An image in memory.
  Impl(const char* image, std::size_t size, const std::string& name)
      : source(name),
        access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, "property list"),
        file((hdf5::silence(), H5Pset_fapl_core(access, std::size_t{1} << 20, false),
              H5Pset_file_image(access, const_cast<char*>(image), size),
              H5Fopen("image-in-memory", H5F_ACC_RDONLY, access)),
             H5Fclose, "opening the file image"),
        root(H5Gopen2(file, "/", H5P_DEFAULT), H5Gclose, source + ": root group") {}

  /// A group of a file on disk. Locks of the library are off: the file never changes, and network file systems may have
  /// none.
  Impl(const std::string& path, const std::string& group)
      : source(path + ": " + group),
        access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, "property list"),
        file((hdf5::silence(), H5Pset_file_locking(access, false, true), H5Fopen(path.c_str(), H5F_ACC_RDONLY, access)),
             H5Fclose, "opening " + path),
        root(H5Gopen2(file, group.c_str(), H5P_DEFAULT), H5Gclose, source) {}

  template <class T>
  std::vector<T> read(const std::string& name) const {
    const Handle data(H5Dopen2(root, name.c_str(), H5P_DEFAULT), H5Dclose, source + ": dataset " + name);
    const Handle space(H5Dget_space(data), H5Sclose, "dataspace");
    std::vector<T> values(static_cast<std::size_t>(std::max<hssize_t>(0, H5Sget_simple_extent_npoints(space))));
    if (!values.empty())
      check(H5Dread(data, type_of<T>(), H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), "dataset read");
    return values;
  }
  template <class T>
  T number(const std::string& name) const {
    const Handle attribute(H5Aopen(root, name.c_str(), H5P_DEFAULT), H5Aclose, source + ": attribute " + name);
    T value{};
    check(H5Aread(attribute, type_of<T>(), &value), "attribute read");
    return value;
  }
};

Hdf5Reader::Hdf5Reader(const std::string& bytes, const std::string& kind, int layout, const std::string& source) {
  const Seal seal = verify_seal(bytes, source);
  if (kind != seal.kind) throw StoreError(fmt::format("{}: holds a {}, not a {}", source, seal.kind, kind));
  if (layout != seal.layout)
    throw StoreError(fmt::format("{}: layout {} of drumsweep {}; this is drumsweep {}, which reads layout {}", source,
                                 seal.layout, seal.version, DRUMSWEEP_VERSION, layout));
  impl_ = std::make_unique<Impl>(bytes.data() + user_block, seal.bytes, source);
}

Hdf5Reader::Hdf5Reader(const std::string& pack_path, const std::string& name) {
  try {
    impl_ = std::make_unique<Impl>(pack_path, name);
    if (hdf5::content_crc(impl_->root) == impl_->number<std::uint32_t>("content_crc32")) return;
  } catch (const std::runtime_error& error) {
    throw StoreError(fmt::format("{}: {} is damaged: {}", pack_path, name, error.what()));
  }
  throw StoreError(fmt::format("{}: {} is damaged: its checksum does not match", pack_path, name));
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
  const Handle attribute(H5Aopen(impl_->root, name.c_str(), H5P_DEFAULT), H5Aclose,
                         impl_->source + ": attribute " + name);
  const Handle type(H5Aget_type(attribute), H5Tclose, "attribute type");
  std::string value(H5Tget_size(type), '\0');
  check(H5Aread(attribute, type, value.data()), "attribute read");
  return value == std::string(1, '\0') ? "" : value;
}

std::vector<std::string> Hdf5Reader::texts(const std::string& name) const {
  const Handle data(H5Dopen2(impl_->root, name.c_str(), H5P_DEFAULT), H5Dclose, impl_->source + ": dataset " + name);
  const Handle type(H5Dget_type(data), H5Tclose, "dataset type");
  const Handle space(H5Dget_space(data), H5Sclose, "dataspace");
  const std::size_t length = H5Tget_size(type);
  std::vector<std::string> values(static_cast<std::size_t>(std::max<hssize_t>(0, H5Sget_simple_extent_npoints(space))));
  std::string bytes(length * values.size(), '\0');
  if (!values.empty()) check(H5Dread(data, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, bytes.data()), "dataset read");
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = bytes.substr(i * length, length).c_str();
  return values;
}

}  // namespace drumsweep
