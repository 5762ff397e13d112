/// Many sealed images in one HDF5 file, for fewer files: one group an image, with all of its datasets and attributes, so
/// that h5dump, h5py and HDFView read a pack as they read a single file.
///
/// A pack is immutable like an image. Its user block (a power of two of bytes, skipped by HDF5) begins with a line as in
/// hdf5_image.h and holds a line an image:
///
///   drumsweep pack of KIND layout L version V block B images N index INDEX_CRC bytes M crc32 CRC
///   NAME IMAGE_CRC IMAGE_BYTES
///
/// INDEX_CRC is of the lines of the images, CRC of the M bytes after the user block. So what is in a pack is known from
/// its first kilobytes, and that it is undamaged from one pass over its bytes. Where it is not, each group has a
/// checksum of its content, and everything of HDF5 that is not data has one too (format of 1.8): what is still good is
/// told from what is not.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "core/io/hdf5_image.h"

namespace drumsweep {

/// One image of a pack, as it was before: CRC and size identify its bytes.
struct PackedImage {
  std::string name;
  std::uint32_t crc = 0;
  std::uint64_t bytes = 0;
};

/// The bytes of a pack. @param images  name and sealed bytes of each, all of one kind and layout
/// @throws StoreError for an image that is damaged
std::string make_pack(const std::vector<std::pair<std::string, std::string>>& images);

/// What a pack says it holds; reads its user block only. @throws StoreError
std::vector<PackedImage> read_pack_index(const std::string& path);

/// One pass over the file. @throws StoreError
void verify_pack(const std::string& path);

/// Names of the groups that a pack still has, for one whose index is damaged.
std::vector<std::string> names_in_pack(const std::string& path);

}  // namespace drumsweep
