/// The page of `drumsweep report` in a browser without a window, and `rescore`, by the real program.
#include <gtest/gtest.h>

#include <algorithm>

#include "cli/browser.h"
#include "cli/mini_json.h"

namespace drumsweep {
namespace {

/// A page around the report: opens it in a frame of that width, clicks twice on the name of the column `f`, points at a
/// mark of a figure, and says what it found.
std::string probe_page(int width) {
  const std::string page = R"html(<!DOCTYPE html><meta charset="utf-8">
<iframe id="frame" src="report.html" style="width:WIDTHpx;height:900px;border:0"></iframe><pre id="out"></pre><script>
const frame = document.getElementById("frame");
frame.onload = () => {
  const page = frame.contentDocument, table = page.querySelector("table.sortable");
  const heads = [...table.tHead.rows[0].cells], column = heads.findIndex((h) => h.textContent.trim() === "f (mm)");
  const values = () => [...table.tBodies[0].rows].map((r) => r.cells[column].textContent);
  const out = {};
  heads[column].querySelector("button").click();
  out.up = values();
  out.sort = heads[column].getAttribute("aria-sort");
  heads[column].querySelector("button").click();
  out.down = values();
  const mark = page.querySelector("svg.chart [data-tip]");
  mark.dispatchEvent(new frame.contentWindow.PointerEvent("pointermove", {bubbles: true, clientX: 50, clientY: 50}));
  out.tip = page.getElementById("tip").textContent;
  out.maps = [...page.querySelectorAll("#contours [data-tip]")].filter((m) => m.dataset.tip.includes(": f = ")).length;
  out.titles = page.querySelectorAll("#contours svg g title, #contours svg path title").length;
  out.overflow = page.documentElement.scrollWidth - frame.clientWidth;
  out.paper = frame.contentWindow.getComputedStyle(page.body).backgroundColor;
  out.ink = frame.contentWindow.getComputedStyle(page.body).color;
  document.getElementById("out").textContent = JSON.stringify(out);
};
</script>)html";
  return replaced(page, "WIDTH", std::to_string(width));
}

Json probed(const TestFolder& folder, int width, const std::vector<std::string>& options) {
  write_text(folder / "probe.html", probe_page(width));
  std::vector<std::string> all = {"--dump-dom", "--virtual-time-budget=20000", "--window-size=1800,1000"};
  all.insert(all.end(), options.begin(), options.end());
  const Finished seen = browse(folder, all, "probe.html");
  EXPECT_EQ(seen.code, 0) << seen.err;
  EXPECT_EQ(seen.err.find("CONSOLE"), std::string::npos) << seen.err;
  const std::size_t begin = seen.out.find("<pre id=\"out\">") + 14, end = seen.out.find("</pre>", begin);
  if (end == std::string::npos || end == begin) {
    ADD_FAILURE() << "the page was not looked at:\n" << seen.out << seen.err;
    return {};
  }
  return JsonReader::parse(seen.out.substr(begin, end - begin));
}

std::vector<double> numbers(const Json& list) {
  std::vector<double> values;
  for (const Json& item : list.list) values.push_back(std::stod(item.text));
  return values;
}

/// Red of "rgb(r, g, b)".
int red(const std::string& colour) { return std::stoi(colour.substr(4)); }

TEST(Report, page_opens_sorts_and_says_values_light_dark_narrow_and_wide) {
  const TestFolder folder;
  write_text(folder / "study.toml", tiny_study());
  ASSERT_EQ(drumsweep(folder, {"run", "study.toml", "-o", "out"}).code, 0);
  const Finished made = drumsweep(folder, {"report", "out", "-o", "report.html", "--no-picture"});
  ASSERT_EQ(made.code, 0) << made.err;
  if (!has_browser())
    GTEST_SKIP() << "chromium is not installed (cluster/packages_test.txt): the page is not looked at";

  const bool has_gnuplot = Program(folder, {"gnuplot", "--version"}).wait() == 0;
  for (const int width : {390, 1600}) {
    const Json seen = probed(folder, width, {});
    const std::vector<double> up = numbers(seen["up"]), down = numbers(seen["down"]);
    ASSERT_EQ(up.size(), 4u);
    EXPECT_TRUE(std::is_sorted(up.begin(), up.end()));
    EXPECT_LT(up.front(), up.back());
    EXPECT_TRUE(std::is_sorted(down.rbegin(), down.rend()));
    EXPECT_EQ(seen["sort"].text, "ascending");
    EXPECT_NE(seen["tip"].text.find("mm"), std::string::npos) << seen["tip"].text;
    EXPECT_LE(seen["overflow"].number, 0) << width;
    // Each of the four designs says its value on the map; the script took the words from where the browser would show them.
    if (has_gnuplot) {
      EXPECT_GE(seen["maps"].number, 4);
      EXPECT_EQ(seen["titles"].number, 0);
    }
    EXPECT_GT(red(seen["paper"].text), 200);
    EXPECT_LT(red(seen["ink"].text), 80);
  }
  const Json dark = probed(folder, 1600, {"--blink-settings=preferredColorScheme=0"});
  EXPECT_LT(red(dark["paper"].text), 60);
  EXPECT_GT(red(dark["ink"].text), 180);

  const std::string picture = folder / "page.png";
  const Finished shot = browse(folder, {"--window-size=1200,1600", "--screenshot=" + picture}, "report.html");
  EXPECT_EQ(shot.code, 0) << shot.err;
  EXPECT_EQ(shot.err.find("CONSOLE"), std::string::npos) << shot.err;
  EXPECT_GT(busy_share(file_text(picture)), 0.005);
}

TEST(Report, works_while_the_sweep_is_unfinished_and_changes_nothing) {
  const TestFolder folder;
  write_text(folder / "study.toml", tiny_study(4, 3));
  ASSERT_EQ(drumsweep(folder, {"run", "study.toml", "-o", "out", "--stop-before", "1"}).code, 3);
  const auto names = [&] {
    std::string all;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder / "out"))
      if (entry.is_regular_file()) all += entry.path().string() + file_text(entry.path().string());
    return all;
  };
  const std::string before = names();
  const Finished made = drumsweep(folder, {"report", "out", "-o", "report.html", "--no-picture"});
  EXPECT_EQ(made.code, 0) << made.err;
  EXPECT_NE(file_text(folder / "report.html").find("This sweep is not finished"), std::string::npos);
  EXPECT_EQ(names(), before);
}

TEST(Report, wrong_use_is_exit_2) {
  const TestFolder folder;
  EXPECT_EQ(drumsweep(folder, {"report", "nowhere", "-o", "r.html"}).code, 2);
  EXPECT_EQ(drumsweep(folder, {"report", ".", "-o", "r.pdf"}).code, 2);
  EXPECT_FALSE(std::filesystem::exists(folder / "r.html"));
  for (const char* command : {"report", "rescore"}) {
    const Finished help = drumsweep(folder, {command, "--help"});
    EXPECT_EQ(help.code, 0);
    EXPECT_NE(help.out.find(std::string("  drumsweep ") + command + " out"), std::string::npos) << help.out;
  }
}

TEST(Rescore, several_belt_speeds_give_a_table_and_a_line_each) {
  const TestFolder folder;
  write_text(folder / "study.toml", tiny_study());
  ASSERT_EQ(drumsweep(folder, {"run", "study.toml", "-o", "out"}).code, 0);
  const Finished done =
      drumsweep(folder, {"rescore", "out", "--belt-speed", "0.125,0.25,0.5", "-o", "new.csv", "--json"});
  ASSERT_EQ(done.code, 0) << done.err;
  const Json json = JsonReader::parse(done.out);
  ASSERT_EQ(json["cases"].list.size(), 3u);
  EXPECT_EQ(json["cases"].list[0]["changes"].text, "belt.speed_m_s=0.125");
  EXPECT_EQ(json["cases"].list[1]["rank_correlation"].number, 1);
  EXPECT_EQ(json["cases"].list[1]["old_optimum"]["change_percent"].number, 0);
  // The same balls on a strip of half the length: about twice the height.
  EXPECT_GT(json["cases"].list[0]["old_optimum"]["change_percent"].number, 50);
  const std::string table = file_text(folder / "new.csv"), summary = file_text(folder / "new_summary.csv");
  EXPECT_EQ(std::count(table.begin(), table.end(), '\n'), 13);
  EXPECT_EQ(std::count(summary.begin(), summary.end(), '\n'), 4);
  EXPECT_EQ(table.rfind("changes,design_id,stage,opening_angle_deg,base_width_m,old_state", 0), 0u) << table;
}

TEST(Rescore, values_that_make_no_sense_are_exit_2_with_key_value_and_range) {
  const TestFolder folder;
  write_text(folder / "study.toml", tiny_study());
  ASSERT_EQ(drumsweep(folder, {"run", "study.toml", "-o", "out"}).code, 0);
  struct Case {
    std::vector<std::string> options, words;
  };
  for (const Case& bad : {Case{{"--belt-speed", "0"}, {"belt.speed_m_s", "0", "0.001 to 20"}},
                          Case{{"--belt-speed", "fast"}, {"belt.speed_m_s", "number"}},
                          Case{{"--weights", "heavy"}, {"objective.weights", "heavy", "decaying"}},
                          Case{{"--set", "feed.rate_kg_s=3"}, {"feed.rate_kg_s", "simulated"}},
                          Case{{"--packing", "0.6", "--set", "objective.packing=0.7"}, {"objective.packing", "twice"}},
                          Case{{}, {"nothing to change"}}}) {
    std::vector<std::string> words = {"rescore", "out", "-o", "new.csv"};
    words.insert(words.end(), bad.options.begin(), bad.options.end());
    const Finished result = drumsweep(folder, words);
    EXPECT_EQ(result.code, 2) << result.err;
    for (const std::string& word : bad.words)
      EXPECT_NE(result.err.find(word), std::string::npos) << word << ": " << result.err;
    // A flag has no lines.
    EXPECT_EQ(result.err.find(":1:"), std::string::npos) << result.err;
  }
  EXPECT_FALSE(std::filesystem::exists(folder / "new.csv"));
}

}  // namespace
}  // namespace drumsweep
