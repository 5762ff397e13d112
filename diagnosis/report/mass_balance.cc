#include "diagnosis/report/mass_balance.h"

#include <initializer_list>

#include "core/config/toml_reader.h"
#include "core/effects/size_distribution.h"
#include "core/scene/conveyor.h"
#include "core/scene/pile.h"
#include "core/scene/rotating_drum.h"
#include "core/scene/scene.h"

namespace drumsweep {
namespace {

/// The known inputs of a condition that balances need; NaN where it has none.
struct KnownInputs {
  double ball_kg = std::nan(""), feed_kg_s = std::nan(""), length_m = std::nan("");
  double belt_kg_s_per_m = std::nan("");  ///< mass flow on the belt for each metre of mean height
  double poured_kg = std::nan("");
};

KnownInputs inputs_of(const Campaign& campaign, const Condition& c) {
  // With the parameters as the bench has them.
  const std::string text =
      extended_text(c, campaign.changes(c, Eigen::VectorXd::Zero(static_cast<Eigen::Index>(campaign.parameters.size())),
                                        Eigen::VectorXd::Zero(static_cast<Eigen::Index>(campaign.candidates.size()))));
  KnownInputs in;
  if (!c.is_scene) {
    const Study s = parse_study(text, c.path);
    in.ball_kg = mean_ball_mass(s);
    in.feed_kg_s = s.feed.rate_kg_s;
    in.belt_kg_s_per_m = s.belt.width_m * s.belt.speed_m_s * s.objective.packing * s.material.density_kg_m3;
    return in;
  }
  const SceneFile file = parse_scene(text, c.path);
  in.ball_kg = mean_ball_mass(file.physics);
  if (const auto* drum = dynamic_cast<const RotatingDrumScene*>(file.scene.get())) {
    in.feed_kg_s = drum->feed_kg_s;
    in.length_m = drum->length_m;
  } else if (const auto* belt = dynamic_cast<const ConveyorScene*>(file.scene.get())) {
    in.feed_kg_s = belt->feed_rate_kg_s;
    in.belt_kg_s_per_m = belt->width_m * belt->belt_speed_m_s * belt->packing * file.physics.material.density_kg_m3;
  } else if (const auto* pile = dynamic_cast<const PileScene*>(file.scene.get())) {
    in.poured_kg = pile->mass_kg;
  }
  return in;
}

}  // namespace

std::vector<MassBalance> mass_balances(const Campaign& campaign, const Problem& problem,
                                       const std::vector<DatumMisfit>& misfits) {
  std::vector<MassBalance> list;
  for (const Condition& condition : campaign.conditions) {
    const KnownInputs in = inputs_of(campaign, condition);
    const auto row = [&](const char* quantity) -> const Datum* {
      for (const Datum& d : problem.data)
        if (d.condition == condition.id && d.quantity == quantity && std::isnan(d.position) &&
            (d.use == Use::fit || d.use == Use::holdout))
          return &d;
      return nullptr;
    };
    /// A product of measured numbers to powers of 1 or -1, times a known factor.
    struct Power {
      const Datum* datum;
      int exponent;
    };
    const auto product = [&](const char* what, double factor, std::initializer_list<Power> powers) {
      MassBalance b{condition.id, what, factor, 0, misfits.empty() ? std::nan("") : factor};
      double relative2 = 0;
      for (const auto& [datum, exponent] : powers) {
        if (datum == nullptr || datum->value == 0) return;
        b.measured *= std::pow(datum->value, exponent);
        relative2 += std::pow(datum->sigma / datum->value, 2);
        if (!misfits.empty())
          b.simulated *=
              std::pow(misfits[static_cast<std::size_t>(datum - problem.data.data())].simulated_before, exponent);
      }
      b.sigma = std::abs(b.measured) * std::sqrt(relative2);
      if (std::isfinite(b.measured)) list.push_back(b);
    };
    product("outflow over feed", 1, {{row("outflow_over_feed"), 1}});
    product("holdup / residence time over feed", in.ball_kg / in.feed_kg_s,
            {{row("holdup"), 1}, {row("residence_time"), -1}});
    product("holdup x axial velocity / length over feed", in.ball_kg / in.length_m / in.feed_kg_s,
            {{row("holdup"), 1}, {row("axial_velocity"), 1}});
    product("mean height x width x belt speed x packing x density over feed", in.belt_kg_s_per_m / in.feed_kg_s,
            {{row("mean_height"), 1}});
    const Datum *on = row("mass_on_base"), *off = row("mass_left_base");
    if (on != nullptr && off != nullptr && in.poured_kg > 0) {
      MassBalance b{condition.id, "on the base and beside it over poured", (on->value + off->value) / in.poured_kg,
                    std::hypot(on->sigma, off->sigma) / in.poured_kg};
      if (!misfits.empty())
        b.simulated = (misfits[static_cast<std::size_t>(on - problem.data.data())].simulated_before +
                       misfits[static_cast<std::size_t>(off - problem.data.data())].simulated_before) /
                      in.poured_kg;
      list.push_back(b);
    }
  }
  return list;
}

}  // namespace drumsweep
