/// A contact problem from a plain list of contacts, each in a pack of its own: visited in the order of the list.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/solver/contact_problem.h"

namespace drumsweep {

struct PlainContact {
  std::uint32_t a;
  int b;  ///< -1: a wall
  Eigen::Vector3d normal, wall_velocity;
  double bias, regularization, friction, arm = 1;
  double rolling = 0, twisting = 0;
  Eigen::Vector3d wall_turn = Eigen::Vector3d::Zero();  ///< arm times the wall's angular velocity [m/s]
};

/// One block a contact, one phase a block.
inline ContactProblem one_by_one(const std::vector<PlainContact>& contacts, std::uint32_t idle_body, bool turning) {
  ContactProblem out;
  out.rotation_resisted = turning;
  const auto set = [](const Eigen::Vector3d& v, float(&to)[3][pack_width]) {
    for (int k = 0; k < 3; ++k) to[k][0] = static_cast<float>(v[k]);
  };
  for (const PlainContact& c : contacts) {
    ContactBlock& block = out.blocks.emplace_back();
    ContactPacks& packs = c.b >= 0 ? block.pairs : block.walls;
    ContactPack row{};
    for (std::size_t lane = 0; lane < pack_width; ++lane) {
      row.a[lane] = row.b[lane] = idle_body;
      row.arm[lane] = 1;
      row.bias[lane] = no_row;
    }
    row.a[0] = c.a;
    if (c.b >= 0) row.b[0] = static_cast<std::uint32_t>(c.b);
    set(c.normal, row.normal);
    row.arm[0] = static_cast<float>(c.arm);
    row.bias[0] = static_cast<float>(c.bias);
    row.regularization[0] = static_cast<float>(c.regularization);
    row.friction[0] = static_cast<float>(c.friction);
    packs.rows.push_back(row);
    packs.impulse.emplace_back();
    packs.active.push_back(0);
    if (c.b < 0) set(c.wall_velocity, packs.wall_velocity.emplace_back().of);
    if (turning) {
      packs.turn.emplace_back();
      packs.limits.push_back({static_cast<float>(c.rolling), static_cast<float>(c.twisting)});
      if (c.b < 0) set(c.wall_turn, packs.wall_turn.emplace_back().of);
    }
    out.phases.push_back({static_cast<std::uint32_t>(out.blocks.size() - 1)});
  }
  return out;
}

inline ImpulsePack& impulse_of(ContactProblem& problem, std::size_t contact) {
  ContactBlock& block = problem.blocks[contact];
  return block.pairs.impulse.empty() ? block.walls.impulse[0] : block.pairs.impulse[0];
}

}  // namespace drumsweep
