#include "sweep/rescore.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "core/config/schema.h"
#include "core/io/durable_file.h"
#include "postproc/child_process.h"
#include "postproc/objective.h"
#include "support/complaint.h"
#include "support/stored_designs.h"

namespace drumsweep {
namespace {

/// A folder of six finished designs with 900 landings each.
class Rescore : public testing::Test {
 protected:
  Rescore() {
    const Store store(folder_, study_);
    write_durably(store.paths().warm_state(), pack_warm_state(study_, made_up_warm_drum()));
    std::uint32_t number = 0;
    for (const PlannedDesign& design : plan_designs(study_).designs)
      write_recording(store.paths(), study_, design, made_up_recording(study_, 40 * number++, 900));
  }
  std::string message_of(const KeyChanges& changes) const {
    return complaint([&] { rescore(folder_, {changes}); });
  }

  Study study_ = grid_study(2, 3);
  ScratchFolder scratch_;
  std::string folder_ = scratch_.path;
};

TEST_F(Rescore, gives_what_evaluating_the_landings_with_the_changed_study_gives) {
  const Rescored all = rescore(folder_, {{"objective.weights=uniform"}, {"belt.speed_m_s=0.5", "objective.modes=4"}});
  ASSERT_EQ(all.before.size(), 6u);
  ASSERT_EQ(all.cases.size(), 2u);
  EXPECT_EQ(all.cases[1].changes, "belt.speed_m_s=0.5 objective.modes=4");
  const Plan plan = plan_designs(study_);
  Study changed = study_;
  changed.belt.speed_m_s = 0.5;
  changed.objective.modes = 4;
  for (std::size_t i = 0; i < plan.designs.size(); ++i) {
    const Recording r = read_design({folder_}, study_, plan.designs[i]).recording.value();
    const Study design = study_of_design(changed, plan.designs[i].values);
    const auto row = std::find_if(all.cases[1].rows.begin(), all.cases[1].rows.end(),
                                  [&](const ResultRow& x) { return x.design_id == plan.designs[i].id; });
    ASSERT_NE(row, all.cases[1].rows.end());
    EXPECT_EQ(row->f_m, evaluate(r.landings, r.begin_s, r.turns, design).f_m);
  }
}

TEST_F(Rescore, the_same_keys_again_change_nothing_and_the_folder_stays_as_it_was) {
  const auto snapshot = [&] {
    std::vector<std::string> files;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_))
      if (entry.is_regular_file()) {
        std::ifstream stream(entry.path(), std::ios::binary);
        files.push_back(entry.path().string() +
                        std::string(std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()));
      }
    std::sort(files.begin(), files.end());
    return files;
  };
  const auto before = snapshot();
  const Rescored all = rescore(folder_, {{"objective.window=belt"}});
  EXPECT_EQ(snapshot(), before);
  EXPECT_EQ(all.cases[0].rank_correlation, 1);
  EXPECT_EQ(all.cases[0].compared, 6u);
  ASSERT_TRUE(all.cases[0].old_optimum && all.cases[0].new_optimum);
  EXPECT_EQ(change_of_f_percent(*all.cases[0].old_optimum), 0);
  EXPECT_EQ(all.cases[0].old_optimum->before.design_id, all.cases[0].new_optimum->before.design_id);
  for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(all.before[i].f_m, all.cases[0].rows[i].f_m);
}

TEST_F(Rescore, packing_scales_heights_and_f_but_not_their_ratio) {
  // Without toppling every height is exactly so many balls over the packing.
  const Rescored all = rescore(folder_, {{"objective.packing=0.35", "objective.friction_angle_deg=80"},
                                         {"objective.packing=0.7", "objective.friction_angle_deg=80"}});
  for (std::size_t i = 0; i < 6; ++i) {
    const ResultRow &half = all.cases[0].rows[i], &whole = all.cases[1].rows[i];
    EXPECT_NEAR(half.mean_height_m, 2 * whole.mean_height_m, 1e-12);
  }
}

TEST_F(Rescore, tables_have_a_line_a_design_and_a_line_a_set) {
  const Rescored all = rescore(folder_, {{"objective.weights=uniform"}, {"objective.weights=growing"}});
  const std::string table = to_csv(all), summary = summary_csv(all);
  EXPECT_EQ(std::count(table.begin(), table.end(), '\n'), 13);
  EXPECT_EQ(std::count(summary.begin(), summary.end(), '\n'), 3);
  for (const std::string& text : {table, summary}) {
    // Every line has as many cells as the first.
    std::size_t cells = 0, count = 0;
    for (const char c : text) {
      if (c == ',') ++count;
      if (c != '\n') continue;
      if (cells == 0) cells = count;
      EXPECT_EQ(count, cells) << text;
      count = 0;
    }
  }
}

TEST_F(Rescore, damaged_and_missing_recordings_are_left_out_and_said) {
  const Plan plan = plan_designs(study_);
  std::filesystem::remove(OutputPaths{folder_}.recording(plan.designs[0].id));
  std::ofstream(OutputPaths{folder_}.recording(plan.designs[1].id), std::ios::app) << "x";
  const Rescored all = rescore(folder_, {{"objective.weights=uniform"}});
  EXPECT_EQ(all.before.size(), 4u);
  EXPECT_EQ(all.without_landings, 2u);
  ASSERT_EQ(all.warnings.size(), 1u);
  EXPECT_NE(all.warnings[0].find(plan.designs[1].id), std::string::npos);
}

TEST_F(Rescore, refuses_values_that_make_no_sense_with_key_value_and_range) {
  struct Case {
    KeyChanges changes;
    std::vector<std::string> words;
  };
  for (const Case& bad : {Case{{"belt.speed_m_s=0"}, {"belt.speed_m_s", "0.001 to 20"}},
                          Case{{"objective.packing=2"}, {"objective.packing", "2", "0.1 to 1"}},
                          Case{{"objective.weights=heavy"}, {"heavy", "decaying"}},
                          Case{{"objective.modes=0"}, {"objective.modes", "1 to", "auto"}},
                          Case{{"objective.wieghts=uniform"}, {"did you mean", "objective.weights"}},
                          Case{{"drum.length_m=3"}, {"drum.length_m", "2.5", "simulated"}},
                          Case{{"outlet.base_width_m=0.05"}, {"outlet.base_width_m"}}, Case{{"seed=3"}, {"seed"}},
                          Case{{"objective.packing"}, {"KEY=VALUE"}}, Case{{"=3"}, {"KEY=VALUE"}},
                          Case{{"objective.packing="}, {"KEY=VALUE"}},
                          Case{{"objective.packing=nan"}, {"objective.packing", "0.1 to 1"}}}) {
    const std::string said = message_of(bad.changes);
    for (const std::string& word : bad.words) EXPECT_NE(said.find(word), std::string::npos) << word << ": " << said;
  }
  EXPECT_THROW(rescore("/nowhere", {{"objective.packing=0.6"}}), InputError);
}

TEST(RankCorrelation, is_that_of_the_ranks_with_mean_ranks_for_ties) {
  EXPECT_EQ(rank_correlation({1, 2, 3}, {10, 200, 3000}), 1);
  EXPECT_EQ(rank_correlation({1, 2, 3}, {3, 2, 1}), -1);
  // Ranks 1, 2.5, 2.5, 4 against 1, 2, 3, 4: 4.5 / sqrt(4.5 * 5).
  EXPECT_NEAR(rank_correlation({1, 5, 5, 9}, {1, 2, 3, 4}), 4.5 / std::sqrt(4.5 * 5), 1e-15);
  EXPECT_TRUE(std::isnan(rank_correlation({1}, {2})));
  EXPECT_TRUE(std::isnan(rank_correlation({1, 1}, {2, 3})));
}

}  // namespace
}  // namespace drumsweep
