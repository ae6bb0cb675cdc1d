// [tables.name], inputs from files and from results: what is read, relative to what, and every mistake with its place.
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "saltus/io/json/json_result.hpp"
#include "saltus/io/sample_files.hpp"
#include "saltus/io/toml/toml_model.hpp"
#include "saltus/model/build.hpp"

namespace saltus::io {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view table_head =
    "[model]\nname = 'm'\n[states]\nx = 1\n[controls]\nu = 0\n[dynamics]\nx = 'road(x) + u'\n";

class Tables : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = (fs::temp_directory_path() / "saltus-tables-XXXXXX").string();
    ASSERT_NE(::mkdtemp(pattern.data()), nullptr);
    folder_ = pattern;
  }
  void TearDown() override { fs::remove_all(folder_); }

  void write(const std::string& name, const std::string& text) { std::ofstream(folder_ / name) << text; }
  Expected<ModelFile> parse(const std::string& rest) {
    return parse_model(std::string(table_head) + rest, (folder_ / "m.toml").string());
  }
  Error refused(const std::string& rest) {
    const auto model = parse(rest);
    EXPECT_FALSE(model.has_value()) << rest;
    return model ? Error{} : model.error();
  }

  fs::path folder_;
};

TEST_F(Tables, OfTheModelFileAndOfAFileBesideIt) {
  write("road.csv", "# measured\nposition; height\r\n0; 0\n\n1; +0.5\n2;\t.25\n");
  const auto model =
      parse("[tables.road]\nfile = 'road.csv'\n[tables.other]\nx = [0, 1, 2, 3]\ny = [1, 2.5, 0, 0]\nkind = 'cubic'\n");
  ASSERT_TRUE(model.has_value()) << to_text(model.error());
  const auto& tables = model->description.tables;
  ASSERT_EQ(tables.size(), 2U);
  EXPECT_EQ(tables[0].name, "road");
  EXPECT_EQ(tables[0].kind, model::TableKind::linear);
  EXPECT_EQ(tables[0].x, (std::vector<double>{0, 1, 2}));
  EXPECT_EQ(tables[0].y, (std::vector<double>{0, 0.5, 0.25}));
  EXPECT_EQ(tables[1].kind, model::TableKind::cubic);
  EXPECT_EQ(tables[1].y[1], 2.5);
  // A table that stands behind its use, and one that nobody uses.
  const auto system = model::build(model->description, {});
  ASSERT_TRUE(system.has_value()) << to_text(system.error());
  EXPECT_EQ(system->cells.size(), 1U);
  ASSERT_EQ(system->warnings.size(), 1U);
  EXPECT_NE(system->warnings[0].find("table 'other' is never used"), std::string::npos);
}

TEST_F(Tables, MistakesInFilesHaveTheLineOfTheFile) {
  struct Case {
    std::string content;
    int line;
    std::string message;
  };
  for (const auto& [content, line, message] : {
           Case{"0,0\n1,1\n1,2\n", 3, "must ascend"},
           Case{"s,h\n0,0\n1,x\n", 3, "expected a number, found 'x'"},
           Case{"0,0\n1,\n", 2, "expected a number, found ''"},
           Case{"0,0\n1,2,3\n", 2, "expected 2 columns as before, found 3"},
           Case{"0 0 0\n", 1, "expected two columns, found 3"},
           Case{"0,0\n1,nan\n", 2, "finite"},
           Case{"0,0\n", 0, "at least 2 points"},
           Case{"", 0, "at least 2 points"},
           Case{"s,h,w\n0,0,0\n", 1, "expected a column 'road'"},
           Case{"0,0\n1,1e999\n", 2, "expected a number"},
           Case{"0,5;1,5\n1;2\n", 1, "expected a number, found '0,5'"},
           Case{"0,0\n1,2,\n", 2, "expected 2 columns as before, found 3\n  end no line with a separator"},
           Case{"PK\x03\x04\n", 0, "this is a zip archive"},
           Case{"MATLAB 5.0 MAT-file, Platform: GLNXA64\n", 0, "this is a MAT-file"},
           Case{"\xFF\xFEt\n", 0, "the file is UTF-16"},
       }) {
    write("road.csv", content);
    const auto error = refused("[tables.road]\nfile = 'road.csv'\n");
    EXPECT_NE((error.message + "\n  " + error.remedy).find(message), std::string::npos) << content << to_text(error);
    EXPECT_EQ(error.location.line, line) << content;
    EXPECT_EQ(fs::path(error.location.file).filename(), "road.csv") << content;
    ASSERT_FALSE(error.context.empty());
    EXPECT_NE(to_text(error).find("[tables.road], line 10"), std::string::npos) << to_text(error);
  }
  const auto missing = refused("[tables.road]\nfile = 'nowhere.csv'\n");
  EXPECT_NE(to_text(missing).find("nowhere.csv"), std::string::npos);
}

TEST_F(Tables, SamplesOfAnInput) {
  write("u.csv", "t,a,u\n0,9,1\n2,9,3\n");
  const auto model =
      parse("[tables.road]\nx = [0, 1]\ny = [0, 1]\n[simulate]\nuntil = 3\ninputs = { u = { file = 'u.csv' } }\n");
  ASSERT_TRUE(model.has_value()) << to_text(model.error());
  const auto& inputs = model->description.sampled_inputs;
  ASSERT_EQ(inputs.size(), 1U);
  EXPECT_EQ(inputs[0].times, (std::vector<double>{0, 2}));
  EXPECT_EQ(inputs[0].values, (std::vector<double>{1, 3}));

  const auto other = with_setting(*model, "simulate.inputs.u.file", (folder_ / "v.csv").string());
  EXPECT_FALSE(other.has_value());
  write("v.csv", "0 7\n");
  const auto changed = with_setting(*model, "simulate.inputs.u.file", (folder_ / "v.csv").string());
  ASSERT_TRUE(changed.has_value()) << to_text(changed.error());
  EXPECT_EQ(changed->description.sampled_inputs.at(0).values, (std::vector<double>{7}));
  const auto expression = with_setting(*model, "simulate.inputs.u", "road(t)");
  ASSERT_TRUE(expression.has_value()) << to_text(expression.error());
  EXPECT_TRUE(expression->description.sampled_inputs.empty());
  EXPECT_EQ(expression->description.inputs.size(), 1U);
  EXPECT_FALSE(with_setting(*model, "simulate.inputs.u.fil", "v.csv").has_value());
}

/// A name says which column is which wherever it stands.
TEST_F(Tables, NamesInAHeaderSayWhichColumnsAreTaken) {
  const std::string with_input =
      "[tables.road]\nx = [0, 1]\ny = [0, 1]\n[simulate]\nuntil = 3\ninputs = { u = { file = 'u.csv' } }\n";
  for (const std::string names : {"u,t\n", "u,time\n", "u,s\n", "\"u\",\"t\"\n"}) {
    write("u.csv", names + "0.5,0\n1.5,1\n");
    const auto model = parse(with_input);
    ASSERT_TRUE(model.has_value()) << names << to_text(model.error());
    EXPECT_EQ(model->description.sampled_inputs.at(0).times, (std::vector<double>{0, 1})) << names;
    EXPECT_EQ(model->description.sampled_inputs.at(0).values, (std::vector<double>{0.5, 1.5})) << names;
  }
  write("u.csv", "u,w,t\n0.5,7,0\n1.5,7,1\n");
  const auto three = parse(with_input);
  ASSERT_TRUE(three.has_value()) << to_text(three.error());
  EXPECT_EQ(three->description.sampled_inputs.at(0).times, (std::vector<double>{0, 1}));
  EXPECT_EQ(three->description.sampled_inputs.at(0).values, (std::vector<double>{0.5, 1.5}));
  for (const std::string names : {"time,voltage\n", "a,b\n", "u,a,b\n", "t,a,b\n"}) {
    write("u.csv", names + (names.size() == 6 ? "0,1,2\n" : "0,1\n"));
    const auto error = refused(with_input);
    EXPECT_NE(error.message.find("expected a column '"), std::string::npos) << names << to_text(error);
    EXPECT_EQ(error.location.line, 1) << names;
  }
  // A table may be over anything: two columns of other names are x and y.
  struct Case {
    std::string names;
    std::vector<double> x, y;
  };
  const std::vector<double> first{0, 1}, second{2, 3};
  for (const auto& [names, x, y] : {Case{"road,t\n", second, first}, Case{"height,x\n", second, first},
                                    Case{"s,road\n", first, second}, Case{"s,h\n", first, second}}) {
    write("road.csv", names + "0,2\n1,3\n");
    const auto model = parse("[tables.road]\nfile = 'road.csv'\n");
    ASSERT_TRUE(model.has_value()) << names << to_text(model.error());
    EXPECT_EQ(model->description.tables.at(0).x, x) << names;
    EXPECT_EQ(model->description.tables.at(0).y, y) << names;
  }
}

TEST_F(Tables, SamplesOfAStoredResult) {
  result::Result stored;
  stored.states = {"x"};
  stored.controls = {"w", "u"};
  stored.final = {2.0, {0.0}, {}, {}, {}};
  stored.trajectory = {{0, 1, 1, 2},     {{0}, {0}, {0}, {0}}, {{5, 1}, {5, 1}, {5, 4}, {5, 4}},
                       {{}, {}, {}, {}}, {{}, {}, {}, {}},     {{}, {}, {}, {}}};
  write("r.json", to_json(stored));
  const std::string road = "[tables.road]\nx = [0, 1]\ny = [0, 1]\n";
  const auto model = parse(road + "[simulate]\nuntil = 3\ninputs = { u = { result = 'r.json' } }\n");
  ASSERT_TRUE(model.has_value()) << to_text(model.error());
  const auto& input = model->description.sampled_inputs.at(0);
  EXPECT_EQ(input.times, (std::vector<double>{0, 1, 2}));
  EXPECT_EQ(input.values, (std::vector<double>{1, 4, 4}));  // of rows at one time the last

  // An optimisation has its controls by interval: exact where the rows are only where somebody wanted them.
  stored.command = "optimize";
  auto& optimization = stored.optimization.emplace();
  optimization.u = {{5, 6}, {5, 7}, {5, 8}, {5, 9}};
  optimization.grid = {0, 0.5, 1, 1.5, 2};
  optimization.h = {{0.5}, {0.5}, {0.5}, {0.5}};
  write("r.json", to_json(stored));
  const auto optimised = parse(road + "[simulate]\nuntil = 3\ninputs = { u = { result = 'r.json' } }\n");
  ASSERT_TRUE(optimised.has_value()) << to_text(optimised.error());
  const auto& intervals = optimised->description.sampled_inputs.at(0);
  EXPECT_EQ(intervals.times, (std::vector<double>{0, 0.5, 1, 1.5}));
  EXPECT_EQ(intervals.values, (std::vector<double>{6, 7, 8, 9}));
  optimization.u[1] = {5};
  write("r.json", to_json(stored));
  const auto ragged = refused(road + "[simulate]\nuntil = 3\ninputs = { u = { result = 'r.json' } }\n");
  EXPECT_NE(ragged.message.find("/u/1"), std::string::npos) << to_text(ragged);
  stored.command = "simulate";
  stored.optimization.reset();

  stored.controls = {"w", "v"};
  write("r.json", to_json(stored));
  const auto error = refused(road + "[simulate]\nuntil = 3\ninputs = { u = { result = 'r.json' } }\n");
  EXPECT_NE(error.message.find("no control 'u'"), std::string::npos) << to_text(error);
  write("r.json", "{");
  EXPECT_EQ(refused(road + "[simulate]\nuntil = 3\ninputs = { u = { result = 'r.json' } }\n").code,
            ErrorCode::parse_failure);
}

}  // namespace
}  // namespace saltus::io
