#include "sweep/report/report.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "core/config/schema.h"
#include "core/io/durable_file.h"
#include "postproc/child_process.h"
#include "support/stored_designs.h"
#include "sweep/store/provenance.h"
#include "sweep/store/results.h"

namespace drumsweep {
namespace {

/// An output folder in which the first `num_done` designs have ended, without a run.
class Folder {
 public:
  Folder(const Study& study, std::size_t num_done, std::uint32_t landings = 300) {
    const Store store(path, study);
    if (num_done > 0) write_durably(store.paths().warm_state(), pack_warm_state(study, made_up_warm_drum()));
    Provenance provenance(store.paths().provenance());
    if (num_done > 0) provenance.add({"run_begin", "", 1, 0, "here", 0, 0, "", "", 1});
    const Plan plan = plan_designs(study);
    ResultTable table{plan.columns, {}};
    std::uint32_t number = 0;
    for (const std::size_t i : table_order(plan)) {
      const PlannedDesign& design = plan.designs[i];
      if (number == num_done) break;
      if (!design.impossible.empty()) continue;
      const Recording recording = made_up_recording(study, 40 * number++, landings);
      provenance.add({"started", design.id, 1, 0, "here", 0, 0, "", ""});
      write_recording(store.paths(), study, design, recording);
      provenance.add({"done", design.id, 1, 0, "here", 0.5, 0.5, "", ""});
      table.rows.push_back(evaluated_row(study, design, recording, true));
    }
    if (num_done > 0) write_durably(store.paths().results(), to_csv(table));
  }
  std::string html() const { return make_report(path, {false}).html; }

 private:
  const ScratchFolder scratch_;

 public:
  const std::string path = scratch_.path;
};

bool has(const std::string& html, const std::string& text) { return html.find(text) != std::string::npos; }

/// Nothing but the page itself is asked for; names of XML are no requests.
void expect_self_contained(const std::string& html) {
  for (const char* request : {"src=\"http", "src=\"/", "src=\"file", "href=\"http", "href=\"/", "url(http", "@import",
                              "<iframe", "<object", "srcset", "//cdn"})
    EXPECT_FALSE(has(html, request)) << request;
}

TEST(Report, a_finished_study_has_all_sections_and_its_names_stay_text) {
  Study study = grid_study(3, 3);
  study.name = "</title><script>alert(1)</script>";
  study.stages[0].name = "<img src=x onerror=alert(2)>";
  const std::string html = Folder(study, 9).html();
  for (const char* id : {"optimum", "contours", "asked", "drum", "search", "noise", "trouble", "solver", "cost",
                         "designs", "provenance"})
    EXPECT_TRUE(has(html, std::string("<section id=\"") + id + "\"")) << id;
  EXPECT_FALSE(has(html, "<script>alert(1)"));
  EXPECT_FALSE(has(html, "<img src=x"));
  EXPECT_FALSE(has(html, "not finished"));
  EXPECT_TRUE(has(html, "4.4 kg/s"));
  expect_self_contained(html);
}

TEST(Report, an_unfinished_study_says_so_first) {
  const std::string html = Folder(grid_study(3, 3), 5).html();
  const std::size_t said = html.find("This sweep is not finished");
  ASSERT_NE(said, std::string::npos);
  EXPECT_LT(said, html.find("class=\"lead\""));
  EXPECT_TRUE(has(html, "5 of 9 known designs have ended"));
  EXPECT_TRUE(has(html, "To go on with this sweep"));
}

TEST(Report, a_study_that_was_never_run_has_a_page_too) {
  const std::string html = Folder(grid_study(2, 2), 0).html();
  EXPECT_TRUE(has(html, "This sweep is not finished"));
  EXPECT_TRUE(has(html, "No design has a result yet"));
  EXPECT_TRUE(has(html, "The warm-up has not begun"));
}

TEST(Report, one_and_three_variables_have_figures) {
  Study one = grid_study(3, 3);
  one.stages[0].variables.pop_back();
  EXPECT_TRUE(has(Folder(one, 3).html(), "Every run over the opening angle"));
  Study three = grid_study(2, 3);
  three.stages[0].variables.push_back({"outlet.bisector_angle_deg", 10, 20, 2, {}});
  const std::string html = Folder(three, 12).html();
  for (const char* name :
       {"Every run over the opening angle", "Every run over the base width", "Every run over the bisector angle"})
    EXPECT_TRUE(has(html, name)) << name;
}

TEST(Report, failed_and_untrusted_designs_have_their_reasons) {
  // Slots as wide as the circumference are impossible; a recording without landings is untrusted.
  Study study = grid_study(2, 2);
  study.stages[0].variables[1].to = 0.9;
  const std::string failed = Folder(study, 2).html();
  EXPECT_TRUE(has(failed, "failed: "));
  EXPECT_TRUE(has(failed, "overlap"));
  EXPECT_FALSE(has(failed, "2 designs failed"));  // a hole of the plan is no accident
  const std::string untrusted = Folder(grid_study(2, 2), 4, 0).html();
  EXPECT_TRUE(has(untrusted, "untrusted: nothing landed"));
  EXPECT_TRUE(has(untrusted, "not to be trusted"));
}

TEST(Report, a_recording_that_cannot_be_read_is_named) {
  const Study study = grid_study(2, 3);
  const Folder folder(study, 6);
  const ResultTable table = read_results_csv(folder.path + "/results.csv");
  for (const ResultRow& row : table.rows)
    std::ofstream(OutputPaths{folder.path}.recording(row.design_id), std::ios::binary) << "torn";
  const Report report = make_report(folder.path, {false});
  const std::size_t named = report.html.find("cannot be read");
  ASSERT_NE(named, std::string::npos);
  EXPECT_TRUE(std::any_of(table.rows.begin(), table.rows.end(), [&](const ResultRow& row) {
    return has(report.html, "The landings of design <code>" + row.design_id + "</code> cannot be read");
  }));
  EXPECT_TRUE(std::any_of(report.notes.begin(), report.notes.end(),
                          [](const std::string& note) { return has(note, "cannot be shown"); }));
}

TEST(Report, two_thousand_rows_stay_below_five_megabytes) {
  const Folder folder(grid_study(50, 40), 3);
  const OutputPaths paths{folder.path};
  const Plan plan = plan_designs(grid_study(50, 40));
  // The rows alone matter for the size: failures need no recording.
  for (std::size_t i = 0; i < plan.designs.size(); ++i)
    if (!std::filesystem::exists(paths.recording(plan.designs[i].id)))
      std::ofstream(paths.failure(plan.designs[i].id))
          << "drumsweep design " + plan.designs[i].id + " failed\nmade up\n";
  const std::string html = folder.html();
  EXPECT_LT(html.size(), 5e6);
  EXPECT_TRUE(has(html, "1997 designs failed"));
}

TEST(Report, refuses_what_is_no_output_folder) { EXPECT_THROW(make_report("/nowhere", {false}), InputError); }

}  // namespace
}  // namespace drumsweep
