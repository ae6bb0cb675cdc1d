// Trajectory and events as arrays of NumPy.
#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <limits>
#include <map>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "saltus/io/impulse_columns_internal.hpp"
#include "saltus/io/json/json_result.hpp"
#include "saltus/io/text_stream_internal.hpp"
#include "saltus/io/zip/npy.hpp"
#include "saltus/io/zip/zip_stream.hpp"
#include "saltus/result/kept_columns.hpp"

namespace saltus::io {
namespace {

static_assert(std::endian::native == std::endian::little, "arrays are written as little-endian numbers");

template <class Number>
void append_number(std::string& bytes, Number number) {
  std::array<char, sizeof(Number)> raw;
  std::memcpy(raw.data(), &number, sizeof(Number));
  bytes.append(raw.data(), raw.size());
}

/// Columns of one table, to which lines are appended, a piece of every column after the other; what is more than a
/// block is put aside on the disk.
class SpooledColumns {
 public:
  SpooledColumns(std::filesystem::path folder, std::string prefix)
      : prefix_(std::move(prefix)), file_(std::move(folder)) {}

  /// Lines of a result whose columns are appended next, in the same order each time.
  void begin(std::size_t from, std::size_t until) {
    from_ = from, until_ = until;
    lines_ += until - from;
    next_ = 0;
  }
  void end() {
    if (waiting_ >= longest_block) put_aside();
  }
  /// A column of value_at(line).
  template <class Number, class ValueAt>
  void numbers(std::string_view name, const char* type, ValueAt value_at) {
    auto& column = next_column("", name, type);
    for (std::size_t line = from_; line < until_; ++line)
      append_number(column.bytes, static_cast<Number>(value_at(line)));
    waiting_ += (until_ - from_) * sizeof(Number);
  }
  /// A column of text_at(line).
  template <class TextAt>
  void words(std::string_view name, TextAt text_at) {
    auto& column = next_column("", name, "");
    for (std::size_t line = from_; line < until_; ++line) append_number(column.bytes, column.words.code(text_at(line)));
    waiting_ += (until_ - from_) * sizeof(std::uint32_t);
  }
  /// Columns of a table of the result, one for each name.
  template <class Number, class ValueAt>
  void table(std::string_view quantity, const std::vector<std::string>& names, const char* type, ValueAt value_at) {
    for (std::size_t i = 0; i < names.size(); ++i) {
      auto& column = next_column(quantity, names[i], type);
      for (std::size_t line = from_; line < until_; ++line) {
        append_number(column.bytes, static_cast<Number>(value_at(line, i)));
      }
    }
    waiting_ += (until_ - from_) * sizeof(Number) * names.size();
  }

  void write_to(ZipStream& zip) {
    for (auto& column : columns_) {
      static_cast<void>(zip.add(column.file, [&](Sink sink) { return write(column, sink); }));
    }
  }
  [[nodiscard]] Expected<void> outcome() const { return file_.outcome(); }

 private:
  static constexpr std::size_t longest_block = std::size_t{1} << 23;
  /// Words by numbers.
  class Words {
   public:
    std::uint32_t code(const std::string& word) {
      const auto [place, is_new] = codes_.emplace(word, static_cast<std::uint32_t>(list_.size()));
      if (is_new) list_.push_back(code_points(word));
      if (is_new) width_ = std::max(width_, list_.back().size());
      return place->second;
    }
    [[nodiscard]] std::size_t width() const { return width_; }
    /// The word of a number as code points, as wide as the longest one.
    void append(std::uint32_t code, std::string& bytes) const {
      const auto& word = list_[code];
      for (std::size_t i = 0; i < width_; ++i) append_number(bytes, i < word.size() ? std::uint32_t{word[i]} : 0U);
    }

   private:
    std::map<std::string, std::uint32_t> codes_;
    std::vector<std::u32string> list_;
    std::size_t width_ = 1;
  };
  struct Column {
    std::string file, type;                                         ///< no type: words
    std::string bytes{};                                            ///< of the lines that are not put aside
    std::vector<std::pair<std::uint64_t, std::uint64_t>> pieces{};  ///< of the others: where, and how many bytes
    Words words{};
  };

  Column& next_column(std::string_view quantity, std::string_view name, const char* type) {
    if (next_ == columns_.size()) {
      auto file = prefix_ + (quantity.empty() ? std::string(name) : fmt::format("{}({})", quantity, name)) + ".npy";
      std::replace(file.begin(), file.end(), '/', '|');  // names of files cannot have a slash
      columns_.push_back({std::move(file), type});
    }
    return columns_[next_++];
  }
  void put_aside() {
    for (auto& column : columns_) {
      column.pieces.emplace_back(file_.size(), column.bytes.size());
      static_cast<void>(file_.write(column.bytes));
      column.bytes.clear();
    }
    waiting_ = 0;
  }
  bool write(const Column& column, Sink sink) {
    const bool of_words = column.type.empty();
    TextStream stream(sink);
    stream.text() = npy_head(of_words ? fmt::format("<U{}", column.words.width()) : column.type, lines_);
    const auto pass = [&](std::string_view bytes) {
      if (!of_words) stream.text() += bytes;
      for (; of_words && !bytes.empty(); bytes.remove_prefix(sizeof(std::uint32_t))) {
        std::uint32_t code = 0;  // pieces are read by multiples of four bytes
        std::memcpy(&code, bytes.data(), sizeof code);
        column.words.append(code, stream.text());
        if (!stream.pass()) return false;
      }
      return stream.pass();
    };
    for (const auto& [from, count] : column.pieces) {
      if (!file_.copy_to(pass, from, count)) return false;
    }
    return pass(column.bytes) && stream.flush();
  }

  std::string prefix_;
  SpoolFile file_;
  std::vector<Column> columns_;
  std::size_t from_ = 0, until_ = 0, lines_ = 0, next_ = 0;
  std::size_t waiting_ = 0;  ///< bytes that are not put aside
};

/// @param before  the time of the row before the first one; NaN if there is none
void add_rows(const result::Result& result, double before, SpooledColumns& columns) {
  const auto& rows = result.trajectory;
  const auto of = [](const auto& table) { return [&table](std::size_t row, std::size_t i) { return table[row][i]; }; };
  columns.numbers<double>("t", "<f8", [&](std::size_t row) { return rows.t[row]; });
  columns.numbers<std::int8_t>(
      "side", "|i1", [&](std::size_t row) { return row == 0 ? (rows.t[0] == before ? 1 : 0) : side(rows, row); });
  const auto functions = functions_in_rows(result);
  columns.table<double>("", states_in_rows(result), "<f8", of(rows.x));
  columns.table<double>("", result.controls, "<f8", of(rows.u));
  columns.table<double>("", result.outputs, "<f8", of(rows.outputs));
  columns.table<double>("alpha", functions, "<f8", of(rows.alpha));
  columns.table<std::int8_t>("mode", functions, "|i1", of(rows.mode));
  for (std::size_t g = 0; g < result.region_groups.size(); ++g) {
    const auto& group = result.region_groups[g].name;
    columns.words(group.empty() ? "regions" : fmt::format("regions({})", group),
                  [&](std::size_t row) { return fmt::format("{}", fmt::join(rows.regions[row][g], "+")); });
  }
  columns.table<double>("theta", result::region_labels(result.region_groups), "<f8", of(rows.theta));
}

void add_events(const result::Result& result, SpooledColumns& columns) {
  const auto& events = result.events;
  columns.numbers<double>("t", "<f8", [&](std::size_t k) { return events.t(k); });
  columns.words("kind", [&](std::size_t k) { return std::string(name(events.kind(k))); });
  columns.words("name", [&](std::size_t k) { return std::string(events.name(k)); });
  columns.words("surfaces", [&](std::size_t k) { return fmt::format("{}", fmt::join(events.surfaces(k), ";")); });
  columns.table<double>("", result.states, "<f8", [&](std::size_t k, std::size_t i) { return events.x(k)[i]; });
  columns.table<double>("after", result.states, "<f8",
                        [&](std::size_t k, std::size_t i) { return events.x_after(k)[i]; });
  // NaN where an event has none
  const auto of = [&](auto side) {
    return [&events, side](std::size_t k, std::size_t i) {
      const auto row = (events.*side)(k);
      return row ? static_cast<double>((*row)[i]) : std::numeric_limits<double>::quiet_NaN();
    };
  };
  using result::Events;
  const auto& functions = result.switching_functions;
  columns.table<double>("mode_before", functions, "<f8", of(&Events::mode_before));
  columns.table<double>("mode_after", functions, "<f8", of(&Events::mode_after));
  columns.table<double>("alpha_before", functions, "<f8", of(&Events::alpha_before));
  columns.table<double>("alpha_after", functions, "<f8", of(&Events::alpha_after));
  const ImpulseColumns impulses(result);
  columns.table<double>("", impulses.names, "<f8", [&](std::size_t k, std::size_t i) {
    return impulses.value(events, k, i).value_or(std::numeric_limits<double>::quiet_NaN());
  });
  columns.numbers<std::int8_t>("unique", "|i1", [&](std::size_t k) { return result::unique_number(events.unique(k)); });
  columns.words("reason", [&](std::size_t k) { return std::string(events.reason(k)); });
}

/// The archive of a result that comes in parts; with branches the lines of each have its label.
class NpzParts : public ResultParts {
 public:
  NpzParts(const std::filesystem::path& folder, Sink sink)
      : rows_(folder, ""), events_(folder, "events."), sink_(sink) {}

  Expected<void> add(const result::Result& part) override {
    add(part, nullptr);
    return put_aside();
  }
  /// @param label  of a whole trajectory, where there are several
  void add(const result::Result& part, const std::string* label) {
    const std::size_t width =
        8 * (2 + part.states.size() + part.controls.size() + part.outputs.size() + 2 * part.switching_functions.size());
    const std::size_t count = std::max<std::size_t>(1, (std::size_t{1} << 20) / width);
    const auto in_pieces = [&](std::size_t lines, SpooledColumns& columns, auto add_piece) {
      std::size_t from = 0;
      do {  // once without lines, too: there are the columns
        const std::size_t until = std::min(lines, from + count);
        columns.begin(from, until);
        add_piece();
        if (label != nullptr) columns.words("branch", [&](std::size_t) { return *label; });
        columns.end();
        from = until;
      } while (from < lines);
    };
    const auto& t = part.trajectory.t;
    if (label != nullptr) last_ = std::numeric_limits<double>::quiet_NaN();
    in_pieces(t.size(), rows_, [&] { add_rows(part, last_, rows_); });
    in_pieces(part.events.size(), events_, [&] { add_events(part, events_); });
    if (!t.empty()) last_ = t.back();
    begun_ = true;
  }
  Expected<void> finish(const result::Result& rest) override {
    if (!begun_) add(rest, nullptr);
    ZipStream zip(sink_);
    rows_.write_to(zip);
    events_.write_to(zip);
    const bool all = zip.finish();
    if (auto aside = put_aside(); !aside) return aside;
    return taken(all);
  }

 private:
  [[nodiscard]] Expected<void> put_aside() const {
    auto rows = rows_.outcome();
    return rows ? events_.outcome() : rows;
  }
  SpooledColumns rows_, events_;
  Sink sink_;
  double last_ = std::numeric_limits<double>::quiet_NaN();  ///< time of the last row
  bool begun_ = false;
};

}  // namespace

std::unique_ptr<ResultParts> npz_parts(const std::filesystem::path& folder, Sink sink) {
  return std::make_unique<NpzParts>(folder, sink);
}

bool write_npz(const result::Result& result, Sink sink) {
  NpzParts parts(std::filesystem::temp_directory_path(), sink);
  for (const auto& [part, label, parent] : result::tree(result)) {
    parts.add(*part, result.branches.empty() ? nullptr : &label);
  }
  return parts.finish(result).has_value();
}

}  // namespace saltus::io
