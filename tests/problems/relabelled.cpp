#include "problems/relabelled.hpp"

#include <algorithm>
#include <cstddef>
#include <stdexcept>
#include <utility>

#include "problems/value_or_throw.hpp"
#include "saltus/expression/parser.hpp"
#include "saltus/model/build.hpp"

namespace saltus::problems {
namespace {

const SourceLocation here{.file = "relabelled"};
constexpr const char* prefix = "relabelled";

expression::NodePtr scaled(double factor, const expression::NodePtr& node) {
  const expression::Binary product{expression::BinaryOperator::multiply, expression::number(factor, here), node};
  return std::make_shared<const expression::Node>(expression::Node{.value = product, .location = here});
}

template <class Vector>
void arrange(Vector& vector, Listing listing) {
  if (listing == Listing::reversed) std::reverse(vector.begin(), vector.end());
}

void arrange_mode(result::Mode& mode, const Relabelling& relabelling) {
  arrange(mode, relabelling.surfaces);
  if (relabelling.psi_factor < 0) {
    for (int& k : mode) k = -k;
  }
}

void arrange_alpha(std::vector<double>& alpha, const Relabelling& relabelling) {
  arrange(alpha, relabelling.surfaces);
  if (relabelling.psi_factor < 0) {
    for (double& value : alpha) value = 1 - value;
  }
}

}  // namespace

const std::vector<Relabelling>& relabellings() {
  static const std::vector<Relabelling> all{
      {.name = "reflected", .psi_factor = -1},
      {.name = "large", .psi_factor = 1e8},
      {.name = "small", .psi_factor = 1e-8},
      {.name = "surfaces reversed", .surfaces = Listing::reversed},
      {.name = "states reversed", .states = Listing::reversed},
      {.name = "all at once", .psi_factor = -1e8, .surfaces = Listing::reversed, .states = Listing::reversed},
  };
  return all;
}

void relabel(io::ModelFile& file, const std::vector<model::Override>& overrides, const Relabelling& relabelling) {
  model::Description& description = file.description;
  const model::System original = value_or_throw(model::build(description, overrides));
  std::vector<model::NamedExpression> renamed;
  for (const model::SwitchingColumn& column : original.columns) {
    // The name of an unnamed switching function is its text.
    const expression::NodePtr psi = value_or_throw(expression::parse(column.name, here));
    renamed.push_back({prefix + std::to_string(renamed.size()), scaled(relabelling.psi_factor, psi), here});
  }
  for (auto& [name, mode] : file.simulate.initial_mode) {
    for (std::size_t j = 0; j < original.columns.size(); ++j) {
      if (original.columns[j].name != name) continue;
      name = prefix + std::to_string(j);
      if (relabelling.psi_factor < 0) mode = -mode;
      break;
    }
  }
  description.definitions.insert(description.definitions.end(), description.switching.begin(),
                                 description.switching.end());
  arrange(renamed, relabelling.surfaces);
  description.switching = std::move(renamed);
  for (model::ModeDescription& mode : description.modes) {
    if (mode.indicator && relabelling.psi_factor > 0) mode.indicator = scaled(relabelling.psi_factor, mode.indicator);
  }
  arrange(description.states, relabelling.states);
}

result::Result in_original_words(result::Result result, const Relabelling& relabelling,
                                 const std::vector<std::string>& surfaces) {
  std::vector<result::Event> events = result.events;
  for (result::Event& event : events) {
    for (std::string& surface : event.surfaces) {
      if (surface.rfind(prefix, 0) == 0) surface = surfaces.at(std::stoul(surface.substr(std::string(prefix).size())));
    }
    const auto place = [&](const std::string& name) { return std::find(surfaces.begin(), surfaces.end(), name); };
    std::sort(event.surfaces.begin(), event.surfaces.end(),
              [&](const std::string& a, const std::string& b) { return place(a) < place(b); });
    for (auto* mode : {&event.mode_before, &event.mode_after}) {
      if (*mode) arrange_mode(**mode, relabelling);
    }
    for (auto* alpha : {&event.alpha_before, &event.alpha_after}) {
      if (*alpha) arrange_alpha(**alpha, relabelling);
    }
    for (auto* x : {&event.x, &event.x_after}) arrange(*x, relabelling.states);
    for (result::Alternative& other : event.alternatives) {
      arrange_mode(other.mode, relabelling);
      arrange_alpha(other.alpha, relabelling);
    }
  }
  result.events = events;
  arrange(result.final.x, relabelling.states);
  arrange_mode(result.final.mode, relabelling);
  arrange_alpha(result.final.alpha, relabelling);
  return result;
}

}  // namespace saltus::problems
