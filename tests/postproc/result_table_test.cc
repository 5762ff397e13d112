#include "postproc/result_table.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <bit>
#include <cmath>

#include "core/config/schema.h"
#include "postproc/child_process.h"
#include "support/complaint.h"
#include "tests/postproc/synthetic.h"

namespace drumsweep {
namespace {

const std::string header =
    "design_id,stage,state,opening_angle_deg,base_width_m,f_m,sigma_f_m,f_footprint_m,sigma_f_footprint_m,"
    "max_an_over_a0,mean_height_m,landed,lost_balls,residual,overlap_95,"
    "force_balance_m_s,iterations,state_hash,reason\n";

class ResultFile : public testing::Test {
 protected:
  ResultTable read(const std::string& content) {
    std::ofstream(folder_ / "results.csv", std::ios::binary) << content;
    return read_results_csv(folder_ / "results.csv");
  }
  /// What reading says about it.
  std::string refusal(const std::string& content) {
    return complaint([&] { read(content); });
  }

  ScratchFolder scratch_;
  std::filesystem::path folder_ = scratch_.path;
};

TEST_F(ResultFile, has_the_columns_in_the_promised_order) {
  EXPECT_EQ(to_csv({{"opening_angle_deg", "base_width_m"}, {}}), header);
}

TEST_F(ResultFile, numbers_are_shortest_and_nan_is_an_empty_cell) {
  ResultRow row;
  row.design_id = "d1";
  row.stage = "coarse";
  row.state = "done";
  row.variables = {0.1, 0.048};
  row.f_m = 1e-3;
  row.landed = 17000;
  row.state_hash = "00ff";
  EXPECT_EQ(to_csv({{"opening_angle_deg", "base_width_m"}, {row}}),
            header + "d1,coarse,done,0.1,0.048,0.001,,,,,,17000,0,,,,,00ff,\n");
}

TEST_F(ResultFile, reads_back_to_the_same_bits_and_text) {
  rc::check([&] {
    const auto number = [] { return std::bit_cast<double>(*rc::gen::arbitrary<std::uint64_t>()); };
    const auto text = [] { return *rc::gen::container<std::string>(rc::gen::element('a', ' ', ',', '"', '\n', '\r')); };
    ResultTable table{{"opening_angle_deg", "base_width_m"}, {}};
    for (int k = *rc::gen::inRange(0, 5); k > 0; --k) {
      ResultRow row;
      row.design_id = text();
      row.stage = text();
      row.state = text();
      row.variables = {number(), number()};
      for (double* value :
           {&row.f_m, &row.sigma_f_m, &row.f_footprint_m, &row.sigma_f_footprint_m, &row.max_an_over_a0,
            &row.mean_height_m, &row.residual, &row.overlap_95, &row.force_balance_m_s, &row.iterations})
        *value = number();
      row.landed = *rc::gen::arbitrary<std::int64_t>();
      row.lost_balls = *rc::gen::arbitrary<std::int64_t>();
      row.state_hash = text();
      row.reason = text();
      table.rows.push_back(row);
    }
    const ResultTable again = read(to_csv(table));
    RC_ASSERT(again.rows.size() == table.rows.size());
    for (std::size_t k = 0; k < table.rows.size(); ++k) {
      const ResultRow &a = table.rows[k], &b = again.rows[k];
      const auto same = [](double x, double y) {
        return (std::isnan(x) && std::isnan(y)) || std::bit_cast<std::uint64_t>(x) == std::bit_cast<std::uint64_t>(y);
      };
      RC_ASSERT(a.design_id == b.design_id && a.stage == b.stage && a.state == b.state);
      RC_ASSERT(a.state_hash == b.state_hash && a.reason == b.reason);
      RC_ASSERT(a.landed == b.landed && a.lost_balls == b.lost_balls);
      RC_ASSERT(same(a.variables[0], b.variables[0]) && same(a.variables[1], b.variables[1]));
      RC_ASSERT(same(a.f_m, b.f_m) && same(a.sigma_f_m, b.sigma_f_m) && same(a.f_footprint_m, b.f_footprint_m));
      RC_ASSERT(same(a.sigma_f_footprint_m, b.sigma_f_footprint_m) && same(a.max_an_over_a0, b.max_an_over_a0));
      RC_ASSERT(same(a.mean_height_m, b.mean_height_m) && same(a.residual, b.residual));
    }
    RC_ASSERT(to_csv(again) == to_csv(table));
  });
}

TEST_F(ResultFile, missing_file_is_named) {
  EXPECT_NE(complaint([&] { read_results_csv(folder_ / "absent.csv"); }).find("absent.csv"), std::string::npos);
}

TEST_F(ResultFile, malformed_files_are_refused_with_file_line_and_reason) {
  const std::string good = "d1,coarse,done,0.1,0.048,0.001,,,,,,17000,0,,,,,00ff,\n";
  const auto expect = [&](const std::string& content, const std::string& where, const std::string& what) {
    const std::string got = refusal(content);
    EXPECT_NE(got.find("results.csv:" + where + ":"), std::string::npos) << got;
    EXPECT_NE(got.find(what), std::string::npos) << got;
  };
  expect("", "1", "empty file");
  expect("design_id,stage\n", "1", "2 columns in the header");
  std::string wrong = header;
  wrong.replace(wrong.find("landed"), 6, "arrived");
  expect(wrong, "1", "column 12 is 'arrived' and should be 'landed'");
  expect(header + good + "d2,coarse,done,0.1\n", "3", "4 cells, 19 expected");
  expect(header + good + "\n", "3", "1 cells");
  expect(header + "d1,coarse,done,0.1,0.048,12mm,,,,,,1,0,,,,,,\n", "2", "f_m = '12mm' is not a number");
  expect(header + "d1,coarse,done,0.1,0.048,,,,,,,1.5,0,,,,,,\n", "2", "landed = '1.5' is not a whole number");
  expect(header + "d1,coarse,done,0.1,0.048,,,,,,,,0,,,,,,\n", "2", "landed = '' is not a whole number");
  expect(header + good + "d1,coarse,done,0.1,0.048,,,,,,,1,0,,,,,,\"torn\n", "3", "not closed");
  expect(header + "d1,coarse,done,0.1,0.048,,,,,,,1,0,,,,,,\"a\"b\n", "2", "after the closing quote");
  // A line break inside a quoted cell counts as a line of the file.
  expect(header + "d1,coarse,failed,0.1,0.048,,,,,,,1,0,,,,,,\"a\nb\"\nd2\n", "4", "1 cells");
}

TEST_F(ResultFile, line_ends_of_other_systems_are_read) {
  const ResultTable table = read(
      "design_id,stage,state,x_m,f_m,sigma_f_m,f_footprint_m,sigma_f_footprint_m,max_an_over_a0,mean_height_m,"
      "landed,lost_balls,residual,overlap_95,force_balance_m_s,iterations,state_hash,reason\r\n"
      "d1,s,done,1,0.5,,,,,,3,0,,,,,h,\"why, then\"\r\n");
  ASSERT_EQ(table.rows.size(), 1U);
  EXPECT_EQ(table.rows[0].reason, "why, then");
  EXPECT_EQ(table.rows[0].f_m, 0.5);
}

TEST_F(ResultFile, row_without_a_value_for_each_variable_is_our_bug) {
  ResultTable table{{"x_m"}, {ResultRow{}}};
  EXPECT_THROW(to_csv(table), std::invalid_argument);
}

TEST(ResultTable, replicates_become_one_row_with_their_mean_and_its_error) {
  ResultTable table{{"base_width_m", "replicate"}, {}};
  const auto add = [&](double width, double replicate, double f, const std::string& state) {
    ResultRow row;
    row.design_id = "id";
    row.stage = "s";
    row.state = state;
    row.variables = {width, replicate};
    row.f_m = f;
    row.sigma_f_m = 0.003;
    table.rows.push_back(row);
  };
  add(0.04, 0, ResultRow::none, "failed");
  add(0.04, 1, 0.010, "done");
  add(0.04, 2, 0.016, "done");
  add(0.05, 0, 0.020, "done");
  add(0.06, 0, ResultRow::none, "failed");
  const ResultTable means = with_means_of_replicates(table);
  EXPECT_EQ(means.variable_names, (std::vector<std::string>{"base_width_m"}));
  ASSERT_EQ(means.rows.size(), 3u);
  EXPECT_DOUBLE_EQ(means.rows[0].f_m, 0.013);
  EXPECT_DOUBLE_EQ(means.rows[0].sigma_f_m, 0.003 / std::sqrt(2));
  EXPECT_EQ(means.rows[0].state, "done");
  EXPECT_EQ(means.rows[1].f_m, 0.020);
  EXPECT_EQ(means.rows[2].state, "failed");
  // Without replicates nothing changes, bit for bit.
  ResultTable plain{{"base_width_m"}, means.rows};
  EXPECT_EQ(to_csv(with_means_of_replicates(plain)), to_csv(plain));
}

}  // namespace
}  // namespace drumsweep
