/// `drumsweep diagnose` as a user runs it, on a campaign of milliseconds.
#include <gtest/gtest.h>

#include "cli/browser.h"
#include "cli/mini_json.h"
#include "diagnosis/campaign/small_campaign.h"
#include "sweep/store/output_lock.h"

namespace drumsweep {

TEST(Diagnose, rolling_resistance_is_found_and_its_gain_adopted) {
  const TestFolder folder;
  write_small_campaign(folder / "c", 0.1);
  const Finished run = drumsweep(folder, {"diagnose", "c/campaign.toml", "-o", "out", "--json"});
  ASSERT_EQ(run.code, 0) << run.err;
  const Json found = JsonReader::parse(run.out);
  EXPECT_EQ(found["verdict"].text, "established") << run.out;
  ASSERT_EQ(found["causes"].list.size(), 1u);
  const Json& cause = found["causes"].list[0].list[0];
  EXPECT_EQ(cause["id"].text, "rolling_resistance");
  EXPECT_LE(cause["low"].number, 0.1);
  EXPECT_GE(cause["high"].number, 0.1);
  EXPECT_GT(found["gain"]["low"].number, 0);
  EXPECT_EQ(found["gain"]["held_out_conditions"].list.size(), 6u);
  // Runs were made close round what explains the data.
  EXPECT_GT(count_files(folder / "out/second_wave", ""), 1u);
  // No observable here sees twisting.
  EXPECT_LT(found["detection_limits"].list[1]["sigma_at_end"].number, 1);
  for (const char* name :
       {"diagnosis.txt", "diagnosis.html", "diagnosis.h5", "misfit.csv", "candidates.csv", "isolation.csv", "gain.csv"})
    EXPECT_FALSE(file_text(folder / "out/" + name).empty()) << name;
  EXPECT_NE(file_text(folder / "out/diagnosis.txt").find("nothing here sees it"), std::string::npos);
  // The extended study is one that the program takes as it is.
  const Finished check = drumsweep(folder, {"check", "out/extended.toml"});
  EXPECT_EQ(check.code, 0) << check.err;
  const std::string extended = file_text(folder / "out/extended.toml");
  EXPECT_NE(extended.find("\nrolling_friction = 0."), std::string::npos) << extended;
  EXPECT_EQ(extended.find("\nrolling_friction = 0.0\n"), std::string::npos) << extended;

  // Other data, nothing simulated again: the plain model is right.
  const auto written = std::filesystem::last_write_time(folder / "out/runs/000000.h5");
  write_text(folder / "c/measured.csv", small_data(0));
  const Finished again = drumsweep(folder, {"diagnose", "c/campaign.toml", "-o", "out", "--json"});
  ASSERT_EQ(again.code, 0) << again.err;
  EXPECT_EQ(JsonReader::parse(again.out)["verdict"].text, "nothing_wrong") << again.out;
  EXPECT_EQ(std::filesystem::last_write_time(folder / "out/runs/000000.h5"), written);
  EXPECT_FALSE(std::filesystem::exists(folder / "out/extended.toml"));
}

TEST(Diagnose, page_opens_with_tables_and_figures_and_no_complaint) {
  const TestFolder folder;
  write_small_campaign(folder / "c", 0.1);
  const Finished run = drumsweep(folder, {"diagnose", "c/campaign.toml", "-o", "out"});
  ASSERT_EQ(run.code, 0) << run.err;
  // The page says what the text says.
  const std::string page = file_text(folder / "out/diagnosis.html"), text = file_text(folder / "out/diagnosis.txt");
  for (const char* words :
       {"ESTABLISHED", "rolling resistance", "nothing here sees it", "held out", "sensor bias of acceleration"}) {
    EXPECT_NE(page.find(words), std::string::npos) << words;
    EXPECT_NE(text.find(words), std::string::npos) << words;
  }
  if (!has_browser())
    GTEST_SKIP() << "chromium is not installed (cluster/packages_test.txt): the page is not looked at";
  const std::string picture = folder / "page.png";
  for (const std::vector<std::string>& options :
       {std::vector<std::string>{"--window-size=1200,1600", "--screenshot=" + picture},
        {"--window-size=390,1600", "--virtual-time-budget=5000", "--dump-dom"}}) {
    const Finished seen = browse(folder, options, "out/diagnosis.html");
    EXPECT_EQ(seen.code, 0) << seen.err;
    EXPECT_EQ(seen.err.find("CONSOLE"), std::string::npos) << seen.err;
    if (options.size() < 3) continue;
    // After its script ran: sortable tables have buttons, marks of the figures say their values.
    EXPECT_NE(seen.out.find("<button type=\"button\">"), std::string::npos);
    EXPECT_NE(seen.out.find("data-tip=\"at_20, acceleration\nmeasured: "), std::string::npos);
    EXPECT_NE(seen.out.find("data-tip=\"rolling resistance: seen above "), std::string::npos);
  }
  EXPECT_GT(busy_share(file_text(picture)), 0.005);
}

TEST(Diagnose, sweeps_of_both_studies_say_what_keeping_the_old_design_costs) {
  const TestFolder folder;
  write_small_campaign(folder / "c", 0.1);
  write_text(folder / "c/study.toml", tiny_study(2, 3));
  ASSERT_EQ(drumsweep(folder, {"diagnose", "c/campaign.toml", "-o", "out"}).code, 0);
  EXPECT_NE(file_text(folder / "out/diagnosis.txt").find("not known yet: run the study"), std::string::npos);
  ASSERT_EQ(drumsweep(folder, {"run", "c/study.toml", "-o", "plain"}).code, 0);
  ASSERT_EQ(drumsweep(folder, {"run", "out/extended.toml", "-o", "extended"}).code, 0);
  const Finished both =
      drumsweep(folder, {"diagnose", "c/campaign.toml", "-o", "out", "--before", "plain", "--after", "extended"});
  EXPECT_EQ(both.code, 0) << both.err;
  for (const char* words : {"keeping the old design costs", "Optimum outlet", "base width (m)"})
    EXPECT_NE(both.out.find(words), std::string::npos) << words << both.out;
  // The one is not the other, and there is one extended study only.
  const Finished swapped =
      drumsweep(folder, {"diagnose", "c/campaign.toml", "-o", "out", "--before", "extended", "--after", "plain"});
  EXPECT_EQ(swapped.code, 2);
  EXPECT_NE(swapped.err.find("there: accepted is a sweep of c/study.toml"), std::string::npos) << swapped.err;
  const Finished two = drumsweep(folder, {"diagnose", "c/campaign.toml", "-o", "out", "--before", "plain", "--after",
                                          "extended", "--after", "extended"});
  EXPECT_EQ(two.code, 2);
  EXPECT_NE(two.err.find("--after is there 2 times"), std::string::npos) << two.err;
}

TEST(Diagnose, result_is_the_same_for_any_ranks_and_interruptions) {
  const TestFolder folder;
  write_small_campaign(folder / "c", 0.1, 120);
  ASSERT_EQ(drumsweep(folder, {"diagnose", "c/campaign.toml", "-o", "one"}).code, 0);
  {
    Program program(folder, under_mpirun(3, {"diagnose", "c/campaign.toml", "-o", "three"}));
    EXPECT_TRUE(wait_until([&] { return count_files(folder / "three/runs", ".h5") > 5; }));
    program.signal(SIGUSR2);
    EXPECT_EQ(program.wait(), 3) << program.err();
  }
  const std::size_t stored = count_files(folder / "three/runs", ".h5");
  EXPECT_LT(stored, 124u);
  {
    // Something damaged is done again.
    write_text(folder / "three/runs/000000.h5", "torn");
    Program program(folder, under_mpirun(2, {"diagnose", "c/campaign.toml", "-o", "three"}));
    EXPECT_EQ(program.wait(), 0) << program.err();
  }
  for (const char* name :
       {"misfit.csv", "candidates.csv", "isolation.csv", "gain.csv", "diagnosis.txt", "diagnosis.h5"})
    EXPECT_EQ(file_text(folder / "one/" + name), file_text(folder / "three/" + name)) << name;
}

TEST(Diagnose, wrong_input_another_campaign_and_a_held_folder_have_their_exit_codes) {
  const TestFolder folder;
  write_small_campaign(folder / "c", 0.1, 25);
  write_text(folder / "c/measured.csv",
             "condition,quantity,position,value,sigma,unit,use\nat_20,acceleration,,1,0,m/s2,fit\n");
  const Finished bad = drumsweep(folder, {"diagnose", "c/campaign.toml", "-o", "out"});
  EXPECT_EQ(bad.code, 2);
  EXPECT_NE(bad.err.find("measured.csv:2: sigma = 0"), std::string::npos) << bad.err;
  EXPECT_EQ(drumsweep(folder, {"diagnose"}).code, 2);
  {
    // With other ranks waiting, too.
    Program program(folder, under_mpirun(2, {"diagnose", "c/campaign.toml", "-o", "out"}));
    EXPECT_EQ(program.wait(), 2) << program.err();
  }
  write_text(folder / "c/measured.csv", small_data(0.1));
  ASSERT_EQ(drumsweep(folder, {"diagnose", "c/campaign.toml", "-o", "out"}).code, 0);
  {
    const OutputLock lock(folder / "out/lock");
    EXPECT_EQ(drumsweep(folder, {"diagnose", "c/campaign.toml", "-o", "out"}).code, 6);
  }
  write_text(folder / "c/campaign.toml", replaced(small_campaign_text(25), "seed = 3", "seed = 4"));
  const Finished other = drumsweep(folder, {"diagnose", "c/campaign.toml", "-o", "out"});
  EXPECT_EQ(other.code, 5);
  EXPECT_NE(other.err.find("seed 3"), std::string::npos) << other.err;
}

TEST(Diagnose, template_can_be_planned_as_it_is) {
  const TestFolder folder;
  ASSERT_EQ(drumsweep(folder, {"diagnose", "--template", "c"}).code, 0);
  const Finished plan = drumsweep(folder, {"diagnose", "c/campaign.toml", "--plan"});
  EXPECT_EQ(plan.code, 0) << plan.err;
  EXPECT_NE(plan.out.find("core-hours"), std::string::npos) << plan.out;
  EXPECT_NE(plan.out.find("then     up to 120 runs"), std::string::npos) << plan.out;
  EXPECT_EQ(drumsweep(folder, {"diagnose", "--template", "c"}).code, 2);
}

}  // namespace drumsweep
