#include "core/solver/packer.h"

#include <algorithm>

namespace drumsweep {

void Packer::begin(std::uint32_t first, std::uint32_t end) {
  first_ = first;
  num_contacts_ = 0;
  open_with_.assign(end - first, 0);
  for (Open& open : open_) open.size = 0;
  packs_.clear();
}

int Packer::oldest() const {
  const auto it =
      std::min_element(open_.begin(), open_.end(), [](const Open& l, const Open& r) { return l.since < r.since; });
  return static_cast<int>(it - open_.begin());
}

void Packer::close(int slot) {
  Open& open = open_[static_cast<std::size_t>(slot)];
  const std::uint32_t others = ~(1u << slot);
  for (std::uint32_t lane = 0; lane < open.size; ++lane)
    for (const std::uint32_t ball : open.ball[lane]) open_with_[ball - first_] &= others;
  std::fill(open.contact.begin() + open.size, open.contact.end(), none);
  packs_.push_back(open.contact);
  open.size = 0;
}

const std::vector<Packer::Lanes>& Packer::finish() {
  for (int slot = 0; slot < static_cast<int>(open_.size()); ++slot)
    if (open_[static_cast<std::size_t>(slot)].size > 0) close(slot);
  return packs_;
}

}  // namespace drumsweep
