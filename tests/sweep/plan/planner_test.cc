#include "sweep/plan/planner.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <random>
#include <set>

#include "core/config/schema.h"
#include "core/config/toml_reader.h"
#include "core/geometry/random.h"
#include "sweep/plan/findings.h"

namespace drumsweep {
namespace {

const std::string head = R"([outlet]
opening_angle_deg = 2.0
base_width_m = 0.04
)";

const std::string coarse = R"([[stage]]
name = "coarse"
type = "grid"
variables = [
  { key = "outlet.opening_angle_deg", from = 0.0, to = 6.0, count = 5 },
  { key = "outlet.base_width_m", from = 0.02, to = 0.06, count = 5 },
]
)";

/// A bowl with its lowest f, 5 mm, at 2.4 deg and 0.041 m; runs of one replicate number share most of their noise.
struct Truth {
  double noise = 0.0001;
  ResultRow row(const PlannedDesign& design) const {
    double angle = 2, width = 0.04, replicate = 0;
    for (const auto& [key, value] : design.values) {
      if (key == "outlet.opening_angle_deg") angle = value;
      if (key == "outlet.base_width_m") width = value;
      if (key == replicate_key) replicate = value;
    }
    ResultRow row;
    row.design_id = design.id;
    row.stage = design.stage;
    row.variables = design.row;
    row.state = design.impossible.empty() ? "done" : "failed";
    const std::uint64_t index = std::stoull(design.id, nullptr, 16);
    const auto own = uniform4(1, Purpose::feed, index),
               shared = uniform4(2, Purpose::feed, static_cast<std::uint64_t>(replicate));
    row.f_m = 0.005 + 0.001 * std::pow(angle - 2.4, 2) + 20 * std::pow(width - 0.041, 2) +
              noise * (own[0] + own[1] - 1 + 3 * (shared[0] - 0.5));
    row.sigma_f_m = noise;
    row.max_an_over_a0 = 0.08;
    return row;
  }
};

/// Plays a whole study: results come one at a time, in an order that `shuffle` decides.
struct Game {
  Study study;
  Planner planner;
  std::map<std::string, ResultRow> rows;
  std::size_t simulated = 0;

  explicit Game(const std::string& text) : study(parse_study(text, "study.toml")), planner(study) {}

  RowOf row_of() const {
    return [this](const PlannedDesign& design) {
      const auto found = rows.find(design.id);
      return found == rows.end() ? nullptr : &found->second;
    };
  }
  void play(const Truth& truth, unsigned shuffle = 0, const std::set<std::string>& holes = {}) {
    std::mt19937 order(shuffle);
    for (int round = 0; round < 100000; ++round) {
      std::vector<const PlannedDesign*> open;
      for (const PlannedDesign& design : planner.plan().designs)
        if (rows.count(design.id) == 0) open.push_back(&design);
      if (open.empty() && !planner.extend(row_of())) break;
      if (open.empty()) continue;
      const PlannedDesign& next = *open[shuffle == 0 ? 0 : order() % open.size()];
      ResultRow row = truth.row(next);
      if (holes.count(next.id) > 0) row.state = "failed";
      rows.emplace(next.id, row);
      ++simulated;
      if (shuffle % 2 == 1) planner.extend(row_of());
    }
    EXPECT_TRUE(planner.complete());
  }
  std::set<std::string> ids() const {
    std::set<std::string> out;
    for (const PlannedDesign& design : planner.plan().designs) out.insert(design.id);
    return out;
  }
  std::string findings() const { return to_toml(planner.plan(), find(study, planner.plan(), row_of())); }
};

const std::string all_searches = head + coarse + R"([[stage]]
name = "closer"
type = "zoom"
nodes = 3
[[stage]]
name = "learn"
type = "adaptive"
budget = 8
batch = 4
[[stage]]
name = "search"
type = "refine"
[[stage]]
name = "confirm"
type = "replicate"
replicates = 5
[refine]
starts = 2
max_evaluations = 15
)";

TEST(Planner, plan_and_findings_do_not_depend_on_the_order_of_results_or_on_interruptions) {
  Game first(all_searches);
  first.play({});
  EXPECT_GT(first.planner.plan().designs.size(), 25u + 9u + 8u);
  Game other(all_searches);
  other.play({}, 3);
  EXPECT_EQ(other.ids(), first.ids());
  EXPECT_EQ(other.findings(), first.findings());
  // Resumed: all results are there from the beginning, nothing is simulated.
  Game resumed(all_searches);
  resumed.rows = first.rows;
  resumed.play({});
  EXPECT_EQ(resumed.simulated, 0u);
  EXPECT_EQ(resumed.ids(), first.ids());
  EXPECT_EQ(resumed.findings(), first.findings());
}

TEST(Planner, the_searches_find_the_optimum_and_confirm_it_with_fresh_replicates) {
  Game game(all_searches);
  game.play({});
  const auto found = find(game.study, game.planner.plan(), game.row_of());
  ASSERT_TRUE(found && found->optimum && found->confirmation);
  EXPECT_NEAR(found->optimum->at[0], 2.4, 0.15);
  EXPECT_NEAR(found->optimum->at[1], 0.041, 0.001);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_LE(found->optimum->low[i], found->optimum->at[i]);
    EXPECT_GE(found->optimum->high[i], found->optimum->at[i]);
  }
  EXPECT_EQ(found->confirmation->num_runs, 5);
  EXPECT_TRUE(found->confirmation->stop_test);
  EXPECT_NEAR(found->confirmation->f_m, 0.005, 4 * found->confirmation->sigma_m + 2e-5);
}

TEST(Planner, every_design_of_a_search_is_inside_its_ranges_and_on_the_lattice) {
  Game game(all_searches);
  game.play({});
  const Box box = search_box(game.study, 1);
  EXPECT_EQ(box[0].resolution, 0.02);
  EXPECT_EQ(box[1].resolution, 0.0002);
  for (const PlannedDesign& design : game.planner.plan().designs) {
    const auto point = point_of(box, game.study, game.planner.plan(), design);
    ASSERT_TRUE(point);
    EXPECT_EQ(quantised(box, *point), *point);
  }
}

TEST(Planner, holes_end_a_start_and_are_never_seen_as_values) {
  Game whole(all_searches);
  whole.play({});
  std::set<std::string> holes;
  for (const std::size_t i : whole.planner.plan().stages[3].designs) holes.insert(whole.planner.plan().designs[i].id);
  for (const std::size_t s : {0u, 1u, 2u})
    for (const std::size_t i : whole.planner.plan().stages[s].designs) holes.erase(whole.planner.plan().designs[i].id);
  Game game(all_searches);
  game.play({}, 0, holes);
  EXPECT_TRUE(game.planner.complete());
}

TEST(Planner, noise_keeps_the_optimiser_away_unless_it_is_forced) {
  const std::string study = head + coarse + "[[stage]]\nname = \"search\"\ntype = \"refine\"\n";
  Game noisy(study);
  noisy.play({0.05});
  EXPECT_LE(noisy.planner.plan().stages[1].designs.size(), 1u);
  Game forced(study + "[refine]\nonly_if_smooth = false\nstarts = 1\nmax_evaluations = 12\n");
  forced.play({0.05});
  EXPECT_GT(forced.planner.plan().stages[1].designs.size(), 1u);
}

TEST(Planner, too_few_results_end_a_search_with_a_reason) {
  const std::string pair = R"([[stage]]
name = "pair"
type = "points"
variables = [ { key = "outlet.opening_angle_deg", values = [1, 2] }, { key = "outlet.base_width_m", values = [0.03, 0.04] } ]
)";
  for (const char* type : {"refine", "zoom", "replicate"}) {
    Game game(head + pair + "[[stage]]\nname = \"s\"\ntype = \"" + type + "\"\n");
    game.play({});
    EXPECT_FALSE(game.planner.plan().stages[1].notes.empty()) << type;
  }
}

TEST(Planner, stages_appended_later_reuse_what_is_done) {
  Game before(head + coarse);
  before.play({});
  Game after(head + coarse + "[[stage]]\nname = \"closer\"\ntype = \"zoom\"\nnodes = 3\n");
  after.rows = before.rows;
  after.play({});
  EXPECT_EQ(after.simulated, after.planner.plan().designs.size() - 25);
  for (const std::string& id : before.ids()) EXPECT_EQ(after.ids().count(id), 1u);
}

TEST(Planner, any_number_of_variables) {
  const std::string study = head + R"([[stage]]
name = "learn"
type = "adaptive"
budget = 24
initial = 16
variables = [
  { key = "outlet.opening_angle_deg", from = 0.0, to = 6.0 },
  { key = "outlet.base_width_m", from = 0.02, to = 0.06 },
  { key = "belt.drop_height_m", from = 0.02, to = 0.1, resolution = 0.01 },
]
)";
  Game game(study);
  game.play({});
  EXPECT_EQ(game.planner.plan().stages[0].designs.size(), 24u);
  const std::string one =
      head +
      "[[stage]]\nname = \"learn\"\ntype = \"adaptive\"\nbudget = 12\ninitial = 8\nvariables = [ { key = "
      "\"outlet.base_width_m\", from = 0.02, to = 0.06 } ]\n"
      "[[stage]]\nname = \"search\"\ntype = \"refine\"\n[refine]\nonly_if_smooth = false\nstarts = 1\n";
  Game line(one);
  line.play({});
  EXPECT_TRUE(find(line.study, line.planner.plan(), line.row_of())->optimum);
}

TEST(Planner, an_adaptive_stage_ends_when_little_is_left_to_gain) {
  const auto designs = [](const std::string& least_gain) {
    Game game(head + "[[stage]]\nname = \"learn\"\ntype = \"adaptive\"\nbudget = 24\ninitial = 8\nbatch = 4\n" +
              least_gain + "variables = [ { key = \"outlet.base_width_m\", from = 0.02, to = 0.06 } ]\n");
    game.play({});
    return game.planner.plan().stages[0].designs.size();
  };
  EXPECT_EQ(designs(""), 24u);
  EXPECT_EQ(designs("least_gain_m = 1.0\n"), 8u);
}

TEST(Planner, a_folder_is_looked_at_without_deciding_anything_anew) {
  Game game(all_searches);
  game.play({});
  Plan plan = plan_designs(game.study);
  restore_searches(plan, game.study, game.findings(), "findings.toml");
  std::set<std::string> ids;
  for (const PlannedDesign& design : plan.designs) ids.insert(design.id);
  EXPECT_EQ(ids, game.ids());
  Plan other = plan_designs(parse_study(head + coarse, "study.toml"));
  EXPECT_THROW(restore_searches(other, game.study, game.findings(), "findings.toml"), InputError);
}

TEST(Planner, an_adaptive_stage_after_too_few_designs_for_a_fit_begins_with_more) {
  Game game(head + R"([[stage]]
name = "coarse"
type = "grid"
variables = [
  { key = "outlet.opening_angle_deg", from = 0.0, to = 6.0, count = 3 },
  { key = "outlet.base_width_m", from = 0.02, to = 0.06, count = 3 },
]
[[stage]]
name = "learn"
type = "adaptive"
budget = 8
initial = 4
batch = 2
)");
  game.play(Truth{});
  EXPECT_EQ(game.planner.plan().stages[1].designs.size(), 8u);
}

}  // namespace
}  // namespace drumsweep
