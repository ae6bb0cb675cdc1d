#include <atomic>
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>
#include <optional>
#include <thread>
#include <tuple>

#include "errors.hpp"
#include "model.hpp"
#include "parts.hpp"
#include "result.hpp"
#include "saltus/base/other_words.hpp"
#include "saltus/frontend/sweep_input.hpp"
#include "saltus/frontend/sweep_page.hpp"
#include "saltus/frontend/sweep_share.hpp"
#include "saltus/frontend/sweep_table.hpp"
#include "saltus/frontend/sweep_warnings.hpp"
#include "saltus/pipeline/options/stated_run.hpp"
#include "watch.hpp"

namespace nb = nanobind;

namespace saltus::python {
namespace {

pipeline::Keep keep_named(const std::string& word) {
  if (word == "final") return pipeline::Keep::final;
  if (word == "events") return pipeline::Keep::events;
  if (word == "trajectory") return pipeline::Keep::trajectory;
  raise({ErrorCode::invalid_option,
         "keep='" + word + "': expected final, events or trajectory",
         suggest_word(word, {"final", "events", "trajectory"}),
         {},
         {}});
}

/// Words of millions of rows, of which most are that of the row before: then they are one object.
nb::list list_of(const std::vector<std::string>& words) {
  nb::list list;
  nb::object last;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (i == 0 || words[i] != words[i - 1]) last = nb::cast(words[i]);
    list.append(last);
  }
  return list;
}

/// A column as an array that owns its numbers, or as a list of words.
nb::object column_of(std::variant<std::vector<double>, std::vector<std::string>> values) {
  if (const auto* words = std::get_if<std::vector<std::string>>(&values)) return list_of(*words);
  return owned_array(std::move(std::get<std::vector<double>>(values)));
}

/// What Python asks a sweep for, as the tool spells it.
struct Sweep {
  frontend::SweepRequest request;
  std::string keep;
  std::size_t jobs = 1;
  frontend::Share share;
  std::size_t before = 0;  ///< runs that stand before those of the request, of which it has a part of the values
};

/// What a warning is until those of all shares are told together.
using SharedWarning = std::pair<std::string, std::vector<std::size_t>>;

void note(nb::list& warnings, const pipeline::SweepWarning& warning) {
  warnings.append(nb::cast(SharedWarning(warning.text, warning.runs)));
}

std::vector<std::string> told_with_runs(std::vector<SharedWarning> warnings) {
  std::vector<pipeline::SweepWarning> all;
  for (auto& [text, runs] : warnings) all.push_back({std::move(text), std::move(runs)});
  return frontend::told_with_runs(all);
}

nb::object sweep(Model& model, const Request& asked, const Sweep& what, nb::object progress, nb::list warnings) {
  const auto plan = value_or_raise(frontend::SweepPlan::make(what.request));
  const auto keep = keep_named(what.keep);
  const auto input = model.stated(asked);
  const auto first = value_or_raise(frontend::input_of_run(input, plan, 0));
  // Results that are kept whole have their branches.
  if (keep != pipeline::Keep::trajectory) value_or_raise(frontend::check_branches(first, plan));
  for (const auto& warning : frontend::options_without_effect(first.file)) note(warnings, {warning, {}});
  Watch watch{nb::none()};
  std::atomic<bool> stopped = false;
  const auto caller = std::this_thread::get_id();
  pipeline::SweepObservers observers;
  // Signals are for the thread that called; what it hears holds for all.
  observers.is_interrupted = [&] {
    if (std::this_thread::get_id() == caller && watch.look()) stopped = true;
    return stopped.load();
  };
  const std::size_t begin = what.share.begin(plan.runs()), count = what.share.end(plan.runs()) - begin;
  const auto total = static_cast<double>(count);
  if (!progress.is_none()) {
    observers.on_run = [&](std::size_t done) {
      if (std::this_thread::get_id() == caller) watch.tell(progress, static_cast<double>(done), total);
    };
  }
  auto outcome = [&] {
    const nb::gil_scoped_release released;
    return pipeline::sweep(
        {count, keep, what.jobs, what.before + begin},
        [&](std::size_t run) { return frontend::state_run(input, plan, begin + run); }, observers);
  }();
  if (!outcome) raise(io::located(outcome.error(), input.file));
  for (const auto& warning : outcome->warnings) note(warnings, warning);
  auto& runs = outcome->runs;
  nb::dict columns;
  for (auto& column : frontend::sweep_table(plan, runs, keep, begin)) {
    if (columns.size() == 0) {
      for (double& run : std::get<std::vector<double>>(column.values)) run += static_cast<double>(what.before);
    }
    columns[nb::str(column.name.c_str())] = column_of(std::move(column.values));
  }
  nb::list results;
  nb::object not_begun;  // one for all of them: they are alike
  for (auto& run : runs) {
    const bool begun = !run.result.states.empty();
    if (!begun && not_begun.is_valid()) {
      results.append(not_begun);
      continue;
    }
    run.result.model.captions = input.file.captions;
    nb::object made = nb::cast(Run{std::make_shared<result::Result>(std::move(run.result)), nullptr, {}, {}, {}});
    if (!begun) not_begun = made;
    results.append(made);
  }
  nb::object found = nb::make_tuple(columns, results, plan.names());
  watch.raise_what_came(found);
  return found;
}

/// (fingerprint, number of runs) of a sweep; refuses one that cannot be.
std::pair<std::string, std::size_t> study(const Model& model, const Request& asked,
                                          const frontend::SweepRequest& request, const std::string& keep) {
  const auto plan = value_or_raise(frontend::SweepPlan::make(request));
  static_cast<void>(keep_named(keep));
  const auto input = model.stated(asked);
  value_or_raise(frontend::input_of_run(input, plan, 0));
  return {frontend::sweep_mark(input, request, keep), plan.runs()};
}

/// The page of a table that Python holds: columns are lists of numbers or of words.
std::string sweep_page(const Model& model, const nb::list& columns, std::vector<std::string> names, std::string command,
                       bool grid) {
  std::vector<frontend::TableColumn> table;
  for (const auto column : columns) {
    const auto [name, words, numbers] =
        nb::cast<std::tuple<std::string, std::vector<std::string>, std::vector<double>>>(column);
    if (words.empty()) {
      table.push_back({name, numbers});
    } else {
      table.push_back({name, words});
    }
  }
  const auto& file = model.input().file;
  return frontend::sweep_page(table,
                              {file.description.name, std::move(command), std::move(names), grid, file.captions});
}

}  // namespace

void add_sweep(nb::class_<Model>& type) {
  type.def("sweep_page", sweep_page, nb::arg("columns"), nb::arg("names"), nb::arg("command"), nb::arg("grid"));
  type.def(
      "study",
      [](const Model& model, std::vector<std::string> settings, std::vector<Option> options,
         std::vector<std::string> over, bool paired, std::vector<std::string> samples, std::optional<long> runs,
         std::uint64_t seed, const std::string& keep, bool yes) {
        const Request asked{std::move(settings), std::move(options), frontend::RunMethods::chosen};
        return study(model, asked, {std::move(over), paired, std::move(samples), runs, seed, yes}, keep);
      },
      nb::arg("settings"), nb::arg("options"), nb::arg("over"), nb::arg("paired"), nb::arg("samples"),
      nb::arg("runs").none(), nb::arg("seed"), nb::arg("keep"), nb::arg("yes"));
  type.def_static("told_with_runs", told_with_runs, nb::arg("warnings"));
  type.def(
      "sweep",
      [](Model& model, std::vector<std::string> settings, std::vector<Option> options, std::vector<std::string> over,
         bool paired, std::vector<std::string> samples, std::optional<long> runs, std::uint64_t seed, std::string keep,
         bool yes, std::size_t jobs, std::tuple<std::size_t, std::size_t, std::size_t> share, nb::object progress,
         nb::list warnings) {
        const Request asked{std::move(settings), std::move(options), frontend::RunMethods::chosen};
        const std::size_t threads = jobs > 0 ? jobs : std::max(1U, std::thread::hardware_concurrency());
        const Sweep what{{std::move(over), paired, std::move(samples), runs, seed, yes},
                         std::move(keep),
                         threads,
                         {std::get<0>(share), std::get<1>(share)},
                         std::get<2>(share)};
        return sweep(model, asked, what, std::move(progress), std::move(warnings));
      },
      nb::arg("settings"), nb::arg("options"), nb::arg("over"), nb::arg("paired"), nb::arg("samples"),
      nb::arg("runs").none(), nb::arg("seed"), nb::arg("keep"), nb::arg("yes"), nb::arg("jobs"), nb::arg("share"),
      nb::arg("progress").none(), nb::arg("warnings"));
}

}  // namespace saltus::python
