/// Arrays that are filled anew in every step and kept for their memory: after the first steps of a steady run nothing is allocated.
#pragma once

#include <utility>
#include <vector>

namespace drumsweep {

/// Room for `num` entries, with an eighth to spare where it has to grow.
template <class T>
void make_room(std::vector<T>& array, std::size_t num) {
  if (array.capacity() < num) array.reserve(num + num / 8 + 4);
}

/// push_back() that grows by an eighth instead of doubling: these arrays are most of a run's memory.
template <class T>
void append(std::vector<T>& array, T value) {
  if (array.size() == array.capacity()) array.reserve(array.size() + array.size() / 8 + 16);
  array.push_back(std::move(value));
}

}  // namespace drumsweep
