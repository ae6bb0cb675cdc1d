#include "saltus/event_integrator/mode/mode_log.hpp"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>

#include "saltus/base/contracts.hpp"

namespace saltus::event_integrator {
namespace {

/// Functions that are compared at once before a difference is looked for.
constexpr std::size_t block = 32;

/// Bit for bit.
template <class Number>
bool are_same(const std::vector<Number>& a, const std::vector<Number>& b, std::size_t begin, std::size_t end) {
  return begin == end || std::memcmp(a.data() + begin, b.data() + begin, (end - begin) * sizeof(Number)) == 0;
}

std::uint64_t bits(double value) { return std::bit_cast<std::uint64_t>(value); }

}  // namespace

std::size_t ModeLog::append(const std::vector<int>& mode, const std::vector<double>& alpha) {
  SALTUS_ASSERT(mode.size() == alpha.size() && (ends_.empty() || mode.size() == last_mode_.size()));
  if (ends_.empty()) {
    first_mode_ = last_mode_ = mode;
    first_alpha_ = last_alpha_ = alpha;
    ends_.push_back(0);
    return 0;
  }
  if (are_same(mode, last_mode_, 0, mode.size()) && are_same(alpha, last_alpha_, 0, mode.size())) {
    return ends_.size() - 1;
  }
  const std::size_t known = changes_.size();
  for (std::size_t begin = 0; begin < mode.size(); begin += block) {
    const std::size_t end = std::min(begin + block, mode.size());
    if (are_same(mode, last_mode_, begin, end) && are_same(alpha, last_alpha_, begin, end)) continue;
    for (std::size_t j = begin; j < end; ++j) {
      if (mode[j] == last_mode_[j] && bits(alpha[j]) == bits(last_alpha_[j])) continue;
      changes_.push_back({j, last_mode_[j], mode[j], alpha[j]});
      last_mode_[j] = mode[j];
      last_alpha_[j] = alpha[j];
    }
  }
  if (changes_.size() > known) ends_.push_back(changes_.size());
  return ends_.size() - 1;
}

std::size_t ModeLog::append_change(std::size_t function, int mode, double alpha) {
  SALTUS_ASSERT(!ends_.empty() && function < last_mode_.size());
  int& last_mode = last_mode_[function];
  double& last_alpha = last_alpha_[function];
  if (mode == last_mode && bits(alpha) == bits(last_alpha)) return ends_.size() - 1;
  changes_.push_back({function, last_mode, mode, alpha});
  last_mode = mode;
  last_alpha = alpha;
  ends_.push_back(changes_.size());
  return ends_.size() - 1;
}

std::size_t ModeLog::append_changes(const std::array<Selected, 2>& selected) {
  SALTUS_ASSERT(!ends_.empty());
  for (const auto& [function, mode, alpha] : selected) {
    SALTUS_ASSERT(function < last_mode_.size());
    changes_.push_back({function, last_mode_[function], mode, alpha});
    last_mode_[function] = mode;
    last_alpha_[function] = alpha;
  }
  ends_.push_back(changes_.size());
  return ends_.size() - 1;
}

void ModeLog::restart() {
  if (ends_.empty()) return;
  first_mode_ = last_mode_;
  first_alpha_ = last_alpha_;
  changes_.clear();
  ends_.assign(1, 0);
}

void ModeLog::append_changed(std::vector<std::size_t>& functions) const {
  if (ends_.size() < 2) return;
  for (std::size_t k = ends_[ends_.size() - 2]; k < ends_.back(); ++k) {
    if (changes_[k].mode != changes_[k].mode_before) functions.push_back(changes_[k].function);
  }
}

bool ModeLog::Reader::begin_before(std::size_t number) {
  SALTUS_ASSERT(number < log_->ends_.size());
  if (next_ != 0 && number + 1 >= next_) return false;
  mode_ = log_->first_mode_;
  alpha_ = log_->first_alpha_;
  next_ = 1;
  return true;
}

}  // namespace saltus::event_integrator
