// Optima of several starts as one.
#include <memory>
#include <nanobind/nanobind.h>
#include <vector>

#include "parts.hpp"
#include "result.hpp"
#include "saltus/frontend/best_of_starts.hpp"

namespace nb = nanobind;

namespace saltus::python {

void add_starts(nb::module_& module) {
  module.def(
      "best_of_starts",
      [](const nb::list& runs) {
        std::vector<std::shared_ptr<result::Result>> optima;
        for (const auto run : runs) optima.push_back(nb::cast<const Run&>(run).result);
        auto best = std::make_shared<result::Result>(frontend::best_of_starts(optima));
        return nb::cast(Run{std::move(best), nullptr, {}, {}, {}});
      },
      nb::arg("runs"));
}

}  // namespace saltus::python
