#include "saltus/report/html.hpp"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include <gtest/gtest.h>

#include "saltus/report/packing_internal.hpp"
#include "sample_optimization.hpp"
#include "sample_results.hpp"
#include "source_folder.hpp"

namespace saltus::report {
namespace {

constexpr const char* plotly = "/*the plotting library*/ const s = \"</SCRIPT>\";";

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t n = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++n;
  return n;
}

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text;
}

TEST(Html, IsOneDocumentWithTheLibraryTheDataAndTheScript) {
  const std::string page = to_html(report_samples::stick_slip(40, 50), plotly);
  EXPECT_TRUE(page.starts_with("<!DOCTYPE html>"));
  EXPECT_TRUE(page.ends_with("</html>\n"));
  EXPECT_NE(page.find("id=\"plotly\">" + deflated_base64(plotly) + "</script>"), std::string::npos);
  EXPECT_NE(page.find("id=\"result\">{"), std::string::npos);
  EXPECT_NE(page.find("saltus.start();"), std::string::npos);
  EXPECT_NE(page.find("<title>stick-slip - Saltus</title>"), std::string::npos);
}

TEST(Html, APageOfAnEmptyRunIsSmall) {
  // What is beside plotly; the small plotly that scripts/make_plotly.sh makes with npm is 0.8 MB more.
  EXPECT_LT(to_html(report_samples::nothing(), plotly).size(), 340000U);
  std::ifstream stream(tests::source_folder(".venv/plotly/plotly.min.js"), std::ios::binary);
  const std::string source{std::istreambuf_iterator<char>(stream), {}};
  EXPECT_LT(to_html(report_samples::nothing(), source).size(), 1200000U);
}

TEST(Html, IsEmptyIfItsMakingIsEnded) {
  const auto result = report_samples::twelve_states();
  int asked = 0;
  const auto whole = to_html(result, plotly, {}, [&] { return ++asked > 0; });
  EXPECT_EQ(whole, to_html(result, plotly));
  for (int last = 1; last < asked; ++last) {
    int again = 0;
    EXPECT_EQ(to_html(result, plotly, {}, [&] { return ++again < last; }), "") << last;
  }
}

TEST(Html, DependsOnTheResultOnly) {
  const auto result = report_samples::twelve_states();
  EXPECT_EQ(to_html(result, plotly), to_html(result, plotly));
}

TEST(Html, NothingInTheResultOrTheLibraryEndsAnElementEarly) {
  const std::string page = lower(to_html(report_samples::failed(), plotly));
  // Four scripts: the data, its numbers, the library, ours. Every opening has exactly one closing tag.
  EXPECT_EQ(count(page, "<script"), 4U);
  EXPECT_EQ(count(page, "</script"), 4U);
  EXPECT_EQ(count(page, "<!--"), 0U);
  EXPECT_EQ(count(page, "<img"), 0U);
  EXPECT_EQ(count(page, "<b>"), 0U);
  EXPECT_NE(page.find("<title>&lt;b&gt;bad&lt;/b&gt; &amp; &quot;odd&quot;"), std::string::npos);
}

TEST(Html, ForbidsRequestsAndScriptsOfOthers) {
  const std::string page = to_html(report_samples::decay(), plotly);
  EXPECT_NE(page.find("default-src 'none'; script-src 'nonce-"), std::string::npos);
  for (const char* outside : {"src=\"", "href=", "@import", "fetch(", "XMLHttpRequest"}) {
    EXPECT_EQ(count(page, outside), 0U) << outside;
  }
  // Parts of pictures are cut by what stands in them.
  EXPECT_EQ(count(page, "url("), count(page, "url(#"));
}

TEST(Html, NonceFollowsTheData) {
  const auto nonce = [](const std::string& page) { return page.substr(page.find("nonce-"), 22); };
  const std::string first = to_html(report_samples::decay(), plotly);
  EXPECT_NE(nonce(first), nonce(to_html(report_samples::failed(), plotly)));
  EXPECT_EQ(count(first, "<script nonce=\"" + nonce(first).substr(6) + "\">"), 1U);
}

/// Not a check but a tool: writes pages to look at when scripts/look_at_report.sh asks for them.
TEST(Html, WritesSamplesOnRequest) {
  const char* folder = std::getenv("SALTUS_REPORT_SAMPLES");
  const char* library = std::getenv("SALTUS_PLOTLY_JS");
  if (folder == nullptr || library == nullptr) GTEST_SKIP() << "SALTUS_REPORT_SAMPLES and SALTUS_PLOTLY_JS are not set";
  std::ifstream stream(library, std::ios::binary);
  const std::string source{std::istreambuf_iterator<char>(stream), {}};
  ASSERT_FALSE(source.empty()) << library;
  const std::vector<std::pair<std::string, result::Result>> samples{{"stick-slip", report_samples::stick_slip(40, 50)},
                                                                    {"no-events", report_samples::decay()},
                                                                    {"twelve-states", report_samples::twelve_states()},
                                                                    {"failed", report_samples::failed()},
                                                                    {"many-rows", report_samples::many_rows(1000000)},
                                                                    {"many-events", report_samples::many_events(20000)},
                                                                    {"nothing", report_samples::nothing()},
                                                                    {"turbo-car", report_samples::turbo_car()}};
  for (const auto& [name, sample] : samples) {
    const auto file = std::filesystem::path(folder) / (name + ".html");
    std::ofstream(file, std::ios::binary) << to_html(sample, source);
    EXPECT_GT(std::filesystem::file_size(file), source.size() / 4);
  }
}

}  // namespace
}  // namespace saltus::report
