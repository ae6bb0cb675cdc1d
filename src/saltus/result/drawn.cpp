#include "saltus/result/drawn.hpp"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

#include "saltus/result/kept_columns.hpp"

namespace saltus::result {
namespace {

/// A row that an event should have.
struct MissingRow {
  std::size_t event = 0;
  bool is_behind = false;  ///< the event, else before it
  std::size_t next = 0;    ///< the row of the trajectory that follows
};

/// Two for each event between the rows; one where there is a row at its time, which is the one behind it.
std::vector<MissingRow> missing_rows(const Result& result) {
  std::vector<MissingRow> missing;
  const auto& t = result.trajectory.t;
  const auto& events = result.events;
  for (std::size_t i = 0, end = 0; i < events.size(); i = end) {
    const double now = events.t(i);
    while (end < events.size() && events.t(end) == now) ++end;
    if (t.empty() || now < t.front() || now > t.back()) continue;
    const auto [first, last] = std::equal_range(t.begin(), t.end(), now);
    if (last - first > 1) continue;
    const auto next = static_cast<std::size_t>(first - t.begin());
    for (std::size_t k = i; k < end; ++k) {
      if (events.kind(k) == EventKind::start) continue;
      missing.push_back({k, false, next});
      if (k + 1 < end || first == last) missing.push_back({k, true, next});
    }
  }
  return missing;
}

/// What an event has itself; else what two rows have in common, not a number where they differ.
template <class Rows>
std::vector<double> own_or_common(const std::vector<double>* own, const Rows& rows, std::size_t a, std::size_t b) {
  if (own != nullptr && own->size() == rows.width()) return *own;
  std::vector<double> values(rows.width());
  for (std::size_t k = 0; k < values.size(); ++k)
    values[k] = rows[a][k] == rows[b][k] ? rows[a][k] : std::numeric_limits<double>::quiet_NaN();
  return values;
}

/// Appends what an event has itself; else what the row before has.
template <class List, class Value>
void append_or_repeat(List& list, const List& rows, std::size_t next, const Value* own) {
  if (rows.empty()) return;
  if (own != nullptr) return list.push_back(*own);
  list.empty() ? list.push_back(rows[next]) : list.repeat();
}

template <class Value>
const Value* pointer(const std::optional<Value>& value) {
  return value ? &*value : nullptr;
}

/// The trajectory of a result and the rows that its events lack.
class Completion {
 public:
  explicit Completion(const Result& result) : of_(result), rows_(result.trajectory) {}

  void copy_up_to(std::size_t end) {
    for (; next_ < end; ++next_) {
      completed_.append(rows_, next_);
      if (of_.drawing) pictures_.push_back(of_.drawing->rows[next_]);
    }
  }

  void add(const MissingRow& row) {
    const Event event = of_.events[row.event];
    const std::size_t next = row.next, before = next > 0 ? next - 1 : 0;
    const auto add_to = [&](auto& list, const auto& rows, const std::vector<double>* own) {
      if (!rows.empty()) list.push_back(own_or_common(own, rows, before, next));
    };
    const auto& contacts = row.is_behind ? event.contact_modes_after : event.contact_modes_before;
    completed_.t.push_back(event.t);
    add_to(completed_.x, rows_.x, row.is_behind ? &event.x_after : &event.x);
    add_to(completed_.alpha, rows_.alpha, pointer(row.is_behind ? event.alpha_after : event.alpha_before));
    add_to(completed_.u, rows_.u, nullptr);
    add_to(completed_.outputs, rows_.outputs, nullptr);
    add_to(completed_.theta, rows_.theta, nullptr);
    append_or_repeat(completed_.mode, rows_.mode, next, pointer(row.is_behind ? event.mode_after : event.mode_before));
    append_or_repeat(completed_.regions, rows_.regions, next,
                     pointer(row.is_behind ? event.regions_after : event.regions_before));
    append_or_repeat(completed_.contact_modes, rows_.contact_modes, next, contacts.empty() ? nullptr : &contacts);
    if (of_.drawing) pictures_.push_back(picture(event.t, before, next));
  }

  /// Hands over what was made; ends its use.
  void move_into(Result& result) {
    copy_up_to(rows_.t.size());
    if (result.drawing) result.drawing->rows = std::move(pictures_);
    result.trajectory = std::move(completed_);
  }

 private:
  /// Bodies do not jump: on straight lines between two rows.
  [[nodiscard]] std::vector<double> picture(double t, std::size_t a, std::size_t b) const {
    const double length = rows_.t[b] - rows_.t[a], share = length > 0.0 ? (t - rows_.t[a]) / length : 0.0;
    std::vector<double> numbers = of_.drawing->rows[a];
    for (std::size_t k = 0; k < numbers.size(); ++k) numbers[k] += share * (of_.drawing->rows[b][k] - numbers[k]);
    return numbers;
  }

  const Result& of_;
  const Trajectory& rows_;
  Trajectory completed_;
  std::vector<std::vector<double>> pictures_;
  std::size_t next_ = 0;  ///< row to be copied
};

void add_rows_at_events(Result& result) {
  for (auto& branch : result.branches) add_rows_at_events(branch);
  const auto missing = missing_rows(result);
  if (missing.empty()) return;
  Completion completion(result);
  for (const auto& row : missing) {
    completion.copy_up_to(row.next);
    completion.add(row);
  }
  completion.move_into(result);
}

bool has_rows_at_events(const Result& result) {
  return missing_rows(result).empty() &&
         std::all_of(result.branches.begin(), result.branches.end(), has_rows_at_events);
}

}  // namespace

std::optional<Result> as_drawn(const Result& result) {
  if (!result.kept && has_rows_at_events(result)) return std::nullopt;
  Result drawn = as_in_rows(result);
  add_rows_at_events(drawn);
  return drawn;
}

}  // namespace saltus::result
