#include <nanobind/nanobind.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "parts.hpp"
#include "result.hpp"

namespace nb = nanobind;

namespace saltus::python {
namespace {

nb::object array_if_there(const std::optional<std::vector<double>>& values) {
  return values ? owned_array(*values) : nb::none();
}

/// With what its event tells: the mode behind it, the selections there, active regions.
std::string alternative_text(const result::Alternative& self) {
  std::string regions;
  for (const auto& active : self.regions) regions += fmt::format(", regions {}", fmt::join(active, "+"));
  return fmt::format("<alternative: mode [{}], alpha [{:.6g}]{}>", fmt::join(self.mode, ", "),
                     fmt::join(self.alpha, ", "), regions);
}

}  // namespace

void add_event(nb::module_& module) {
  nb::class_<result::Alternative>(module, "Alternative", "A continuation that was possible at an event.")
      .def_ro("mode", &result::Alternative::mode)
      .def_prop_ro("alpha", [](const result::Alternative& self) { return owned_array(self.alpha); })
      .def_ro("regions", &result::Alternative::regions)
      .def("__repr__", alternative_text);
  nb::class_<result::Intersection>(module, "Intersection", "Where the modes of two surfaces were decided together.")
      .def_ro("surfaces", &result::Intersection::surfaces)
      .def_ro("velocities", &result::Intersection::velocities)
      .def_ro("alpha_before", &result::Intersection::alpha_before)
      .def_ro("alpha_after", &result::Intersection::alpha_after);
  using Event = RunEvent;
  nb::class_<Event>(module, "Event", "A change of mode, a jump, or an event of the user.")
      .def_ro("t", &Event::t)
      .def_prop_ro("kind", [](const Event& self) { return std::string(name(self.kind)); })
      .def_ro("name", &Event::name)
      .def_ro("turned", &Event::turned)
      .def_ro("surfaces", &Event::surfaces)
      .def_ro("mode_before", &Event::mode_before)
      .def_ro("mode_after", &Event::mode_after)
      .def_prop_ro("alpha_before", [](const Event& self) { return array_if_there(self.alpha_before); })
      .def_prop_ro("alpha_after", [](const Event& self) { return array_if_there(self.alpha_after); })
      .def_ro("regions_before", &Event::regions_before)
      .def_ro("regions_after", &Event::regions_after)
      .def_prop_ro("contact_modes_before", [](const Event& self) { return words_of(self.contact_modes_before); })
      .def_prop_ro("contact_modes_after", [](const Event& self) { return words_of(self.contact_modes_after); })
      .def_ro("impulse", &Event::impulse)
      .def_prop_ro("states", [](const Event& self) { return self.states ? *self.states : std::vector<std::string>(); })
      .def_prop_ro("x", [](const Event& self) { return owned_array(self.x); })
      .def_prop_ro("x_after", [](const Event& self) { return owned_array(self.x_after); })
      .def_ro("unique", &Event::unique)
      .def_ro("alternatives", &Event::alternatives)
      .def_ro("reason", &Event::reason)
      .def_ro("intersection", &Event::intersection)
      .def("__repr__", [](const Event& self) {
        auto what = self.name ? *self.name : fmt::format("{}", fmt::join(self.surfaces, ", "));
        if (self.turned) what += " " + *self.turned;
        return fmt::format("<{} of {} at t = {:.9g}>", name(self.kind), what.empty() ? "the model" : what, self.t);
      });
}

}  // namespace saltus::python
