#include "postproc/gnuplot.h"

#include <gtest/gtest.h>

namespace drumsweep {
namespace {

TEST(ForPage, takes_the_pages_ink_and_its_own_ids_and_keeps_marks_on_coloured_ground) {
  const std::string svg =
      "<?xml version=\"1.0\"?>\n<svg \n width=\"400\" height=\"300\"\n viewBox=\"0 0 400 "
      "300\">\n<title>Gnuplot</title>\n"
      "<path id='gpPt0'/><use xlink:href='#gpPt0' id='gpPt6' color='rgb( 16,  16,  16)'/>\n"
      "<g color=\"black\" stroke=\"currentColor\"><path stroke='rgb(  0,   0,   0)'/>\n"
      "<text fill=\"rgb(0,0,0)\" font-family=\"DejaVu Sans, sans-serif\">f</text></g></svg>\n";
  const std::string page = for_page(svg, {"fig7-", "a \"map\" & more"});
  EXPECT_TRUE(page.starts_with("<svg ")) << page;
  EXPECT_EQ(page.find("black"), std::string::npos);
  EXPECT_EQ(page.find("rgb(0,0,0)"), std::string::npos);
  EXPECT_EQ(page.find("rgb(  0,   0,   0)"), std::string::npos);
  EXPECT_NE(page.find("rgb( 16,  16,  16)"), std::string::npos);
  EXPECT_NE(page.find("id='fig7-gpPt0'"), std::string::npos) << page;
  EXPECT_NE(page.find("xlink:href='#fig7-gpPt0'"), std::string::npos) << page;
  EXPECT_NE(page.find("id='fig7-gpPt6'"), std::string::npos) << page;
  EXPECT_NE(page.find("aria-label=\"a &quot;map&quot; &amp; more\" width=\"100%\" viewBox"), std::string::npos) << page;
  EXPECT_EQ(page.find("DejaVu"), std::string::npos);
  EXPECT_EQ(page.find("<title>"), std::string::npos);
}

TEST(WithError, has_the_decimals_that_the_error_allows) {
  EXPECT_EQ(with_error(11.6123, 0.213), "11.6 ± 0.2");
  EXPECT_EQ(with_error(11.6123, 0.0134), "11.612 ± 0.013");
  EXPECT_EQ(with_error(11.6123, 0.0), "11.6");
}

TEST(Wrapped, breaks_between_words_and_keeps_all_of_them) {
  EXPECT_EQ(wrapped("one two three", 7), (std::vector<std::string>{"one two", "three"}));
  EXPECT_EQ(wrapped("unbreakable", 3), (std::vector<std::string>{"unbreakable"}));
}

TEST(NiceStep, is_not_below_and_needs_few_decimals) {
  EXPECT_DOUBLE_EQ(nice_step(0.3), 0.5);
  EXPECT_DOUBLE_EQ(nice_step(21), 25);
  EXPECT_EQ(decimals_of(0.25), 2);
  EXPECT_EQ(decimals_of(20), 0);
}

}  // namespace
}  // namespace drumsweep
