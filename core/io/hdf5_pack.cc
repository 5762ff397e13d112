#include "core/io/hdf5_pack.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <functional>
#include <sstream>

#include "core/io/hdf5_handle.h"

namespace drumsweep {
namespace {

using hdf5::check;
using hdf5::Handle;

/// zlib begins anew when it is given no place, even for no bytes.
std::uint32_t crc_of(std::uint32_t crc, const void* data, std::size_t size) {
  if (size == 0) return crc;
  return static_cast<std::uint32_t>(crc32_z(crc, static_cast<const Bytef*>(data), size));
}

/// The first line of a pack, in numbers.
struct PackHead {
  std::size_t block = 0, images = 0;
  std::uint64_t bytes = 0;
  unsigned int index_crc = 0, crc = 0;
};

PackHead parse_head(const std::string& line, const std::string& path) {
  char kind[64] = "", version[64] = "";
  int layout = 0;
  PackHead head;
  unsigned long long bytes = 0;
  if (std::sscanf(line.c_str(),
                  "drumsweep pack of %63s layout %d version %63s block %zu images %zu index %x bytes %llu crc32 %x",
                  kind, &layout, version, &head.block, &head.images, &head.index_crc, &bytes, &head.crc) != 8 ||
      head.block < 512 || head.block > (std::size_t{1} << 24))
    throw StoreError(path + ": is not a pack of recordings, or its first line is damaged");
  head.bytes = bytes;
  return head;
}

std::ifstream open_pack(const std::string& path, PackHead& head) {
  std::ifstream stream(path, std::ios::binary);
  std::string line;
  if (!stream || !std::getline(stream, line)) throw StoreError(path + ": cannot be read");
  head = parse_head(line, path);
  return stream;
}

/// Kind, layout and version of the images, as in their seals.
std::string common_head(const std::vector<std::pair<std::string, std::string>>& images, std::string& index) {
  std::string common;
  for (const auto& [name, bytes] : images) {
    const Seal seal = verify_seal(bytes, name);
    const std::string own = fmt::format("{} layout {} version {}", seal.kind, seal.layout, seal.version);
    if (!common.empty() && own != common)
      throw StoreError(fmt::format("{}: {} cannot be in one pack with {}", name, own, common));
    common = own;
    index += fmt::format("{} {:08x} {}\n", name, seal.crc, seal.bytes);
  }
  return common;
}

/// Copies all that an image holds into the group `name` of `file`.
void copy_image(hid_t file, const std::string& name, const std::string& bytes) {
  const hdf5::MemoryAccess access;
  const std::size_t begin = bytes.size() - verify_seal(bytes, name).bytes;
  check(H5Pset_file_image(access, const_cast<char*>(bytes.data() + begin), bytes.size() - begin), "file image");
  const Handle image(H5Fopen("image-to-copy", H5F_ACC_RDONLY, access), H5Fclose, "opening " + name);
  check(H5Ocopy(image, "/", file, name.c_str(), H5P_DEFAULT, H5P_DEFAULT), "copy");
  const Handle group(H5Gopen2(file, name.c_str(), H5P_DEFAULT), H5Gclose, name);
  hdf5::write_number(group, "content_crc32", hdf5::content_crc(group));
}

/// Walks a group and adds to a CRC; exceptions do not cross the library.
struct CrcWalk {
  std::uint32_t crc = 0;
  void add(const void* data, std::size_t size) { crc = crc_of(crc, data, size); }
  void add(const std::string& text) { add(text.c_str(), text.size() + 1); }

  /// Type, shape and values, as the file has them.
  void add_values(hid_t type, hid_t space, const std::function<herr_t(void*)>& read) {
    std::vector<hsize_t> shape(static_cast<std::size_t>(std::max(0, H5Sget_simple_extent_ndims(space))));
    if (!shape.empty()) H5Sget_simple_extent_dims(space, shape.data(), nullptr);
    const std::size_t size = H5Tget_size(type);
    const hssize_t count = H5Sget_simple_extent_npoints(space);
    if (count < 0 || size == 0) throw std::runtime_error("HDF5: a type or shape cannot be read");
    std::vector<char> values(static_cast<std::size_t>(count) * size);
    if (!values.empty()) check(read(values.data()), "read");
    add(shape.data(), shape.size() * sizeof(hsize_t));
    add(&size, sizeof size);
    add(values.data(), values.size());
  }
  void add_attribute(hid_t object, const char* name) {
    if (std::strcmp(name, "content_crc32") == 0) return;
    const Handle attribute(H5Aopen(object, name, H5P_DEFAULT), H5Aclose, "attribute");
    const Handle type(H5Aget_type(attribute), H5Tclose, "type"), space(H5Aget_space(attribute), H5Sclose, "space");
    add(std::string(name));
    add_values(type, space, [&](void* out) { return H5Aread(attribute, type, out); });
  }
  void add_object(hid_t object);
};

template <class Visit>
herr_t guarded(const Visit& visit) {
  try {
    visit();
    return 0;
  } catch (const std::exception&) {
    return -1;
  }
}

void CrcWalk::add_object(hid_t object) {
  hsize_t at = 0;
  check(H5Aiterate2(
            object, H5_INDEX_NAME, H5_ITER_INC, &at,
            [](hid_t of, const char* name, const H5A_info_t*, void* walk) {
              return guarded([&] { static_cast<CrcWalk*>(walk)->add_attribute(of, name); });
            },
            this),
        "attributes");
  if (H5Iget_type(object) == H5I_DATASET) {
    const Handle type(H5Dget_type(object), H5Tclose, "type"), space(H5Dget_space(object), H5Sclose, "space");
    add_values(type, space, [&](void* out) { return H5Dread(object, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, out); });
    return;
  }
  at = 0;
  check(H5Literate(
            object, H5_INDEX_NAME, H5_ITER_INC, &at,
            [](hid_t in, const char* name, const H5L_info_t*, void* walk) {
              return guarded([&] {
                const Handle child(H5Oopen(in, name, H5P_DEFAULT), H5Oclose, name);
                static_cast<CrcWalk*>(walk)->add(std::string(name));
                static_cast<CrcWalk*>(walk)->add_object(child);
              });
            },
            this),
        "members");
}

}  // namespace

std::uint32_t hdf5::content_crc(hid_t object) {
  CrcWalk walk;
  walk.add_object(object);
  return walk.crc;
}

std::string make_pack(const std::vector<std::pair<std::string, std::string>>& images) {
  std::string index;
  const std::string common = common_head(images, index);
  const hdf5::MemoryFile memory;
  for (const auto& [name, bytes] : images) copy_image(memory.file, name, bytes);

  std::size_t block = 512;
  while (block < index.size() + 300) block *= 2;
  std::string pack = memory.image(block);
  const std::string head = fmt::format("drumsweep pack of {} block {} images {} index {:08x} bytes {} crc32 {:08x}\n",
                                       common, block, images.size(), crc_of(0, index.data(), index.size()),
                                       pack.size() - block, crc_of(0, pack.data() + block, pack.size() - block));
  std::memcpy(pack.data(), head.data(), head.size());
  std::memcpy(pack.data() + head.size(), index.data(), index.size());
  return pack;
}

std::vector<PackedImage> read_pack_index(const std::string& path) {
  PackHead head;
  std::ifstream stream = open_pack(path, head);
  std::vector<PackedImage> images;
  std::uint32_t crc = 0;
  std::string line;
  for (std::size_t i = 0; i < head.images && std::getline(stream, line); ++i) {
    std::istringstream words(line);
    PackedImage image;
    words >> image.name >> std::hex >> image.crc >> std::dec >> image.bytes;
    images.push_back(std::move(image));
    line += '\n';
    crc = crc_of(crc, line.data(), line.size());
  }
  if (images.size() != head.images || crc != head.index_crc) throw StoreError(path + ": damaged: its index");
  return images;
}

void verify_pack(const std::string& path) {
  PackHead head;
  std::ifstream stream = open_pack(path, head);
  stream.seekg(static_cast<std::streamoff>(head.block));
  std::vector<char> piece(std::size_t{1} << 20);
  std::uint64_t bytes = 0;
  std::uint32_t crc = 0;
  while (stream.read(piece.data(), static_cast<std::streamsize>(piece.size())) || stream.gcount() > 0) {
    const auto size = static_cast<std::size_t>(stream.gcount());
    crc = crc_of(crc, piece.data(), size);
    bytes += size;
  }
  if (bytes != head.bytes)
    throw StoreError(fmt::format("{}: damaged: {} bytes where {} were written", path, bytes, head.bytes));
  if (crc != head.crc) throw StoreError(path + ": damaged: its checksum does not match");
}

std::vector<std::string> names_in_pack(const std::string& path) {
  std::vector<std::string> names;
  try {
    hdf5::silence();
    const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, "property list");
    check(H5Pset_file_locking(access, false, true), "locking");
    const Handle file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, access), H5Fclose, "opening " + path);
    hsize_t at = 0;
    H5Literate(
        file, H5_INDEX_NAME, H5_ITER_INC, &at,
        [](hid_t, const char* name, const H5L_info_t*, void* list) {
          return guarded([&] { static_cast<std::vector<std::string>*>(list)->emplace_back(name); });
        },
        &names);
  } catch (const std::runtime_error&) {
    // Nothing in it can be read.
  }
  return names;
}

}  // namespace drumsweep
