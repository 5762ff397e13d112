#include "postproc/report/html.h"

#include <gtest/gtest.h>

namespace drumsweep {
namespace {

TEST(Html, text_is_escaped_so_that_no_name_becomes_markup) {
  EXPECT_EQ(escaped("<script>alert('1 & 2')</script>\""),
            "&lt;script&gt;alert(&#39;1 &amp; 2&#39;)&lt;/script&gt;&quot;");
  EXPECT_EQ(escaped("Kugel­mühle 0.2° µm"), "Kugel­mühle 0.2° µm");
}

TEST(Html, what_is_not_utf8_or_not_allowed_in_html_is_replaced) {
  const std::string mark = "\xef\xbf\xbd";
  EXPECT_EQ(escaped("a\xff"
                    "b"),
            "a" + mark + "b");
  EXPECT_EQ(escaped("\xc3"), mark);                        // cut off
  EXPECT_EQ(escaped("\xc0\xaf"), mark + mark);             // overlong
  EXPECT_EQ(escaped("\xed\xa0\x80"), mark + mark + mark);  // surrogate
  EXPECT_EQ(escaped(std::string("\0\x1b\x7f\n", 4)), mark + mark + mark + "\n");
}

TEST(Html, data_urls_are_base64_of_rfc_4648) {
  EXPECT_EQ(data_url("", "image/png"), "data:image/png;base64,");
  EXPECT_EQ(data_url("f", "x"), "data:x;base64,Zg==");
  EXPECT_EQ(data_url("fo", "x"), "data:x;base64,Zm8=");
  EXPECT_EQ(data_url("foobar", "x"), "data:x;base64,Zm9vYmFy");
  EXPECT_EQ(data_url("\xff\xfe\xfd", "x"), "data:x;base64,//79");
}

TEST(Html, a_page_has_its_style_and_script_and_asks_for_nothing_else) {
  const std::string page = html_of(Page{"a <b> title", "<h1>h</h1>", {{"one", "First & last", "<p>text</p>"}}, "end"});
  EXPECT_EQ(page.rfind("<!DOCTYPE html>", 0), 0u);
  EXPECT_NE(page.find("<title>a &lt;b&gt; title</title>"), std::string::npos);
  EXPECT_NE(page.find("<a href=\"#one\">First &amp; last</a>"), std::string::npos);
  EXPECT_NE(page.find("prefers-color-scheme: dark"), std::string::npos);
  EXPECT_NE(page.find("@media print"), std::string::npos);
  EXPECT_NE(page.find("aria-sort"), std::string::npos);
  for (const char* resource : {"http:", "https:", "@import", "url(", "<script src", "<link rel=\"stylesheet"})
    EXPECT_EQ(page.find(resource), std::string::npos) << resource;
}

TEST(Html, rows_beyond_those_for_paper_are_for_the_screen) {
  HtmlTable table{{{"n", true}, {"t"}}, {{{"1", ""}, {"a", ""}}, {{"2", "2.5"}, {"b", ""}}}, true, 1};
  const std::string html = html_of(table);
  EXPECT_NE(html.find("<tr><td class=\"n\">1</td>"), std::string::npos) << html;
  EXPECT_NE(html.find("<tr class=\"screen\"><td class=\"n\" data-v=\"2.5\">2</td>"), std::string::npos) << html;
}

}  // namespace
}  // namespace drumsweep
