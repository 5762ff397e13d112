/// Distributes contacts over packs so that no ball is twice in a pack: a greedy colouring with a window of open packs.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/simd/targets.h"

namespace drumsweep {

class Packer {
 public:
  static constexpr std::uint32_t none = 0xFFFFFFFFu;
  using Lanes = std::array<std::uint32_t, pack_width>;

  /// Begins anew. Contacts are then numbered in the order they are added.
  /// @param first,end  places of the balls that contacts may name
  void begin(std::uint32_t first, std::uint32_t end);

  /// Puts the next contact into the first open pack that has neither ball. A wall contact names its ball twice.
  void add(std::uint32_t a, std::uint32_t b) {
    std::uint32_t &of_a = open_with_[a - first_], &of_b = open_with_[b - first_];
    const std::uint32_t free = ~(of_a | of_b);
    const int slot = free != 0 ? __builtin_ctz(free) : oldest();
    if (free == 0) close(slot);
    const std::uint32_t bit = 1u << slot;
    Open& open = open_[static_cast<std::size_t>(slot)];
    if (open.size == 0) open.since = num_contacts_;
    of_a |= bit;
    of_b |= bit;
    open.contact[open.size] = num_contacts_++;
    open.ball[open.size++] = {a, b};
    if (open.size == pack_width) close(slot);
  }

  /// Closes the packs that are still open. Lanes without a contact are `none`.
  const std::vector<Lanes>& finish();

 private:
  struct Open {
    Lanes contact;
    std::array<std::array<std::uint32_t, 2>, pack_width> ball;
    std::uint32_t size = 0, since = 0;
  };
  int oldest() const;
  void close(int slot);

  std::uint32_t first_ = 0, num_contacts_ = 0;
  std::vector<std::uint32_t> open_with_;  ///< (balls) bit s: it is in the open pack s
  std::array<Open, 32> open_;
  std::vector<Lanes> packs_;
};

}  // namespace drumsweep
