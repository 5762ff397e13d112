/// An HDF5 file in memory.
#pragma once

#include <hdf5.h>

#include <string>
#include <utility>
#include <vector>

namespace drumsweep {

/// Opens what is for other programs as any would that knows HDF5 only.
struct OpenImage {
  std::string bytes;
  hid_t access = H5Pcreate(H5P_FILE_ACCESS), file = -1;
  explicit OpenImage(std::string image) : bytes(std::move(image)) {
    H5Pset_fapl_core(access, 1 << 20, false);
    H5Pset_file_image(access, bytes.data(), bytes.size());
    file = H5Fopen("image", H5F_ACC_RDONLY, access);
  }
  ~OpenImage() {
    H5Fclose(file);
    H5Pclose(access);
  }
  OpenImage(const OpenImage&) = delete;
  OpenImage& operator=(const OpenImage&) = delete;

  std::vector<hsize_t> shape(const std::string& name) const {
    const hid_t data = H5Dopen2(file, name.c_str(), H5P_DEFAULT);
    if (data < 0) return {};
    const hid_t space = H5Dget_space(data);
    std::vector<hsize_t> out(static_cast<std::size_t>(H5Sget_simple_extent_ndims(space)));
    H5Sget_simple_extent_dims(space, out.data(), nullptr);
    H5Sclose(space);
    H5Dclose(data);
    return out;
  }
  std::vector<double> values(const std::string& name) const {
    std::size_t num = 1;
    for (const hsize_t n : shape(name)) num *= n;
    std::vector<double> out(num);
    const hid_t data = H5Dopen2(file, name.c_str(), H5P_DEFAULT);
    H5Dread(data, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, out.data());
    H5Dclose(data);
    return out;
  }
};

}  // namespace drumsweep
