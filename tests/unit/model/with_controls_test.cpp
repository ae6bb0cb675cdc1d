// Piecewise constant controls put into a system.
#include <gtest/gtest.h>

#include "saltus/model/builder.hpp"
#include "saltus/model/ocp.hpp"

namespace saltus::model {
namespace {

using casadi::SX;

const std::vector<double> times{0.0, 0.5, 1.0, 1.5};
const std::vector<std::vector<double>> values{{1.0, 0.0}, {1.0, 2.0}, {-1.0, 2.0}, {3.0, 2.0}};

Builder two_controls() {
  Builder model("two controls");
  const SX x = model.state("x", {0.0});
  const SX u = model.control("u", {}), w = model.control("w", {.initial = 0.25});
  model.dynamics("x", u + w * model.step(x - 1, "edge"));
  return model;
}

System built(Builder& model) {
  auto system = model.build();
  EXPECT_TRUE(system.has_value()) << (system ? "" : to_text(system.error()));
  return system ? *system : System{};
}

TEST(WithControlsTest, CellsAreThoseOfSampledInputs) {
  Builder plain = two_controls(), sampled = two_controls();
  sampled.input("u", times, {1.0, 1.0, -1.0, 3.0});
  sampled.input("w", times, {0.0, 2.0, 2.0, 2.0});
  const System system = with_controls(built(plain), times, values), expected = built(sampled);
  ASSERT_EQ(system.cells.size(), 2U);
  ASSERT_EQ(expected.cells.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(system.cells[i].name, expected.cells[i].name);
    EXPECT_EQ(system.cells[i].symbols.numel(), expected.cells[i].symbols.numel());
    EXPECT_EQ(system.cells[i].table->kind, expected.cells[i].table->kind);
    EXPECT_EQ(system.cells[i].table->change, expected.cells[i].table->change);
    EXPECT_EQ(system.cells[i].table->breaks, expected.cells[i].table->breaks);
    EXPECT_EQ(system.cells[i].table->constants, expected.cells[i].table->constants);
    EXPECT_TRUE(SX::is_equal(system.cells[i].argument, system.t));
  }
  EXPECT_EQ(system.cells[0].table->breaks, (std::vector<double>{1.0, 1.5}));  // equal neighbours are one cell
  EXPECT_EQ(system.cells[1].table->constants, (std::vector<double>{0.0, 2.0}));
  EXPECT_EQ(system.input.size(), expected.input.size());
}

TEST(WithControlsTest, InputsBeforeAreGoneWithTheirCells) {
  Builder model = two_controls();
  model.input("u", model.floor(3 * model.time()));
  model.output("phase", model.floor(model.time()));
  model.input("w", 2 * model.floor(model.time()));
  const System system = built(model);
  ASSERT_EQ(system.cells.size(), 2U);
  const System controlled = with_controls(system, times, values);
  ASSERT_EQ(controlled.cells.size(), 3U);
  EXPECT_EQ(controlled.cells[0].name.substr(0, 5), "floor");
  EXPECT_TRUE(SX::depends_on(controlled.outputs, controlled.cells[0].symbols));  // the output keeps its own
  EXPECT_FALSE(SX::depends_on(controlled.input, controlled.t));
}

TEST(WithControlsTest, SystemsWithoutControlsStayAsTheyAre) {
  Builder model("free");
  model.dynamics("x", -model.state("x", {1.0}));
  const System system = with_controls(built(model), {0.0}, {{}});
  EXPECT_TRUE(system.cells.empty());
  EXPECT_EQ(system.input.numel(), 0);
}

}  // namespace
}  // namespace saltus::model
