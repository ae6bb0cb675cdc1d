// Trajectory and events as arrays of NumPy.
#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <limits>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "saltus/io/json/json_result.hpp"
#include "saltus/io/text_stream_internal.hpp"
#include "saltus/io/zip/npy.hpp"
#include "saltus/io/zip/zip_stream.hpp"

namespace saltus::io {
namespace {

static_assert(std::endian::native == std::endian::little, "arrays are written as little-endian numbers");

template <class Number>
void append_number(std::string& bytes, Number number) {
  std::array<char, sizeof(Number)> raw;
  std::memcpy(raw.data(), &number, sizeof(Number));
  bytes.append(raw.data(), raw.size());
}

/// Entries of the archive, each over the lines of a result and its branches.
class ColumnWriter {
 public:
  ColumnWriter(const std::vector<result::TreeEntry>& parts, ZipStream& zip) : parts_(parts), zip_(zip) {}

  /// @param lines  of a part of the result
  void set_lines(std::string prefix, std::size_t (*lines)(const result::Result&)) {
    prefix_ = std::move(prefix);
    lines_ = lines;
  }
  /// A column of value_at(part, line).
  template <class Number, class ValueAt>
  void numbers(const std::string& name, const char* type, ValueAt value_at) {
    add(name, type, [&](std::string& bytes, const result::TreeEntry& part, std::size_t line) {
      append_number(bytes, static_cast<Number>(value_at(*part.result, line)));
    });
  }
  /// A column of text_at(part, line), as wide as the longest one.
  template <class TextAt>
  void words(const std::string& name, TextAt text_at) {
    std::size_t width = 1;
    for_each([&](const auto& part, std::size_t line) {
      width = std::max(width, code_points(text_at(part, line)).size());
      return true;
    });
    add(name, fmt::format("<U{}", width), [&](std::string& bytes, const auto& part, std::size_t line) {
      auto text = code_points(text_at(part, line));
      text.resize(width);
      for (const char32_t point : text) append_number(bytes, static_cast<std::uint32_t>(point));
    });
  }
  /// Columns of a table of the result, one for each name.
  template <class Number, class RowAt>
  void table(const char* quantity, const std::vector<std::string>& names, const char* type, RowAt row_at) {
    for (std::size_t i = 0; i < names.size(); ++i) {
      const auto name = *quantity == '\0' ? names[i] : fmt::format("{}({})", quantity, names[i]);
      numbers<Number>(name, type, [&](const result::Result& part, std::size_t line) { return row_at(part, line, i); });
    }
  }

 private:
  template <class Look>
  bool for_each(Look look) const {
    for (const auto& part : parts_) {
      const std::size_t count = lines_(*part.result);
      for (std::size_t line = 0; line < count; ++line) {
        if (!look(part, line)) return false;
      }
    }
    return true;
  }
  template <class Append>
  void add(const std::string& name, const std::string& type, Append append) {
    std::size_t count = 0;
    for (const auto& part : parts_) count += lines_(*part.result);
    // Names of files cannot have a slash.
    auto file = prefix_ + name + ".npy";
    std::replace(file.begin(), file.end(), '/', '|');
    static_cast<void>(zip_.add(file, [&](Sink sink) {
      TextStream stream(sink);
      stream.text() = npy_head(type, count);
      for_each([&](const auto& part, std::size_t line) {
        append(stream.text(), part, line);
        return stream.pass();
      });
      return stream.flush();
    }));
  }

  const std::vector<result::TreeEntry>& parts_;
  ZipStream& zip_;
  std::string prefix_;
  std::size_t (*lines_)(const result::Result&) = nullptr;
};

void add_rows(const result::Result& result, ColumnWriter& columns) {
  columns.set_lines("", [](const result::Result& part) { return part.trajectory.t.size(); });
  using Part = const result::Result&;
  const auto of = [](auto member) {
    return [member](Part part, std::size_t row, std::size_t i) { return (part.trajectory.*member)[row][i]; };
  };
  columns.numbers<double>("t", "<f8", [](Part part, std::size_t row) { return part.trajectory.t[row]; });
  columns.numbers<std::int8_t>("side", "|i1", [](Part part, std::size_t row) { return side(part.trajectory, row); });
  columns.table<double>("", result.states, "<f8", of(&result::Trajectory::x));
  columns.table<double>("", result.controls, "<f8", of(&result::Trajectory::u));
  columns.table<double>("", result.outputs, "<f8", of(&result::Trajectory::outputs));
  columns.table<double>("alpha", result.switching_functions, "<f8", of(&result::Trajectory::alpha));
  columns.table<std::int8_t>("mode", result.switching_functions, "|i1", of(&result::Trajectory::mode));
  for (std::size_t g = 0; g < result.region_groups.size(); ++g) {
    const auto& group = result.region_groups[g].name;
    columns.words(group.empty() ? "regions" : fmt::format("regions({})", group),
                  [g](const auto& part, std::size_t row) {
                    return fmt::format("{}", fmt::join(part.result->trajectory.regions[row][g], "+"));
                  });
  }
  columns.table<double>("theta", result::region_labels(result.region_groups), "<f8", of(&result::Trajectory::theta));
}

void add_events(const result::Result& result, ColumnWriter& columns) {
  columns.set_lines("events.", [](const result::Result& part) { return part.events.size(); });
  using Part = const result::Result&;
  using result::Events;
  const auto words = [&](const char* name, auto of) {
    columns.words(name, [of](const auto& part, std::size_t k) { return std::string(of(part.result->events, k)); });
  };
  columns.numbers<double>("t", "<f8", [](Part part, std::size_t k) { return part.events.t(k); });
  words("kind", [](const Events& events, std::size_t k) { return name(events.kind(k)); });
  words("name", [](const Events& events, std::size_t k) { return events.name(k); });
  words("surfaces",
        [](const Events& events, std::size_t k) { return fmt::format("{}", fmt::join(events.surfaces(k), ";")); });
  columns.table<double>("", result.states, "<f8",
                        [](Part part, std::size_t k, std::size_t i) { return part.events.x(k)[i]; });
  columns.table<double>("after", result.states, "<f8",
                        [](Part part, std::size_t k, std::size_t i) { return part.events.x_after(k)[i]; });
  // NaN where an event has none
  const auto of = [](auto side) {
    return [side](Part part, std::size_t k, std::size_t i) {
      const auto row = (part.events.*side)(k);
      return row ? static_cast<double>((*row)[i]) : std::numeric_limits<double>::quiet_NaN();
    };
  };
  const auto& functions = result.switching_functions;
  columns.table<double>("mode_before", functions, "<f8", of(&Events::mode_before));
  columns.table<double>("mode_after", functions, "<f8", of(&Events::mode_after));
  columns.table<double>("alpha_before", functions, "<f8", of(&Events::alpha_before));
  columns.table<double>("alpha_after", functions, "<f8", of(&Events::alpha_after));
  columns.numbers<std::int8_t>("unique", "|i1", [](Part part, std::size_t k) {
    const auto unique = part.events.unique(k);
    return !unique ? -1 : *unique ? 1 : 0;
  });
  words("reason", [](const Events& events, std::size_t k) { return events.reason(k); });
}

}  // namespace

bool write_npz(const result::Result& result, Sink sink) {
  ZipStream zip(sink);
  const auto parts = result::tree(result);
  ColumnWriter columns(parts, zip);
  const auto add_branch = [&] {
    if (!result.branches.empty()) columns.words("branch", [](const auto& part, std::size_t) { return part.label; });
  };
  add_rows(result, columns);
  add_branch();
  add_events(result, columns);
  add_branch();
  return zip.finish();
}

}  // namespace saltus::io
