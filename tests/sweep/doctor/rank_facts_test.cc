#include "sweep/doctor/rank_facts.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace drumsweep {
namespace {

RankFacts rank_on(const std::string& host, std::vector<int> cpus, int online = 4) {
  return {host, std::move(cpus), online, 8'000'000'000, "scalar", "1.0"};
}

const Finding& about(const std::vector<Finding>& findings, const std::string& subject) {
  const auto found =
      std::find_if(findings.begin(), findings.end(), [&](const Finding& f) { return f.subject == subject; });
  if (found == findings.end()) throw std::runtime_error("nothing about " + subject);
  return *found;
}

Finding::Level binding(const std::vector<RankFacts>& facts, int threads) {
  return about(judge_ranks(facts, threads), "binding").level;
}

TEST(Rank_facts, arrive_as_they_were_sent) {
  const RankFacts own = own_facts("here");
  const RankFacts back = unpack_facts(pack_facts(own));
  EXPECT_EQ(pack_facts(back), pack_facts(own));
  EXPECT_EQ(back.cpus, own.cpus);
  EXPECT_FALSE(own.cpus.empty());
  EXPECT_GT(own.available_bytes, 1'000'000);
}

TEST(Rank_facts, cpus_are_written_as_ranges) {
  EXPECT_EQ(cpu_ranges({0, 1, 2, 5, 7, 8}), "0-2,5,7-8");
  EXPECT_EQ(cpu_ranges({}), "");
}

TEST(Judge_ranks, bindings_that_make_ranks_wait_are_warned_of) {
  using Level = Finding::Level;
  const std::vector<int> all{0, 1, 2, 3};
  EXPECT_EQ(binding({rank_on("a", all), rank_on("a", all)}, 2), Level::ok);
  EXPECT_EQ(binding({rank_on("a", {0}), rank_on("a", {1})}, 1), Level::ok);
  // Both on one core while three are idle; both alone on the same one; threads on one core; too many of all.
  EXPECT_EQ(binding({rank_on("a", {0}), rank_on("a", {0})}, 1), Level::warning);
  EXPECT_EQ(binding({rank_on("a", {0}), rank_on("a", {0}), rank_on("a", all)}, 1), Level::warning);
  EXPECT_EQ(binding({rank_on("a", {0}), rank_on("a", {1, 2, 3})}, 2), Level::warning);
  EXPECT_EQ(binding({rank_on("a", all), rank_on("a", all), rank_on("a", all)}, 2), Level::warning);
  // Cores are counted host by host.
  EXPECT_EQ(binding({rank_on("a", all), rank_on("b", {0})}, 2), Level::warning);
  EXPECT_EQ(binding({rank_on("a", {0}), rank_on("b", {0})}, 1), Level::ok);
}

TEST(Judge_ranks, hosts_builds_and_memory_are_compared) {
  std::vector<RankFacts> facts{rank_on("a", {0}), rank_on("b", {0}), rank_on("b", {1})};
  EXPECT_EQ(about(judge_ranks(facts, 1), "ranks").text, "3 see each other: 1 on a; 2 on b");
  facts[1].available_bytes = 150'000'000;  // for two
  EXPECT_EQ(about(judge_ranks(facts, 1), "memory").level, Finding::Level::warning);
  facts[2].version = "2.0";
  EXPECT_EQ(about(judge_ranks(facts, 1), "versions").level, Finding::Level::problem);
}

}  // namespace
}  // namespace drumsweep
