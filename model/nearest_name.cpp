#include "model/nearest_name.hpp"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <numeric>
#include <utility>

namespace poise {
namespace {

// Comparing names costs the product of their lengths; nobody misspells one of this length.
constexpr std::size_t longest_compared = 200;

}  // namespace

int edit_distance(std::string_view a, std::string_view b) {
  // row[j] is the distance from the first i letters of a to the first j of b; a swap uses the row before the last.
  std::vector<int> before_last(b.size() + 1), last(b.size() + 1), row(b.size() + 1);
  std::iota(row.begin(), row.end(), 0);
  for (std::size_t i = 1; i <= a.size(); ++i) {
    before_last.swap(last);
    last.swap(row);
    row[0] = static_cast<int>(i);
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const int replaced = last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      row[j] = std::min({replaced, last[j] + 1, row[j - 1] + 1});
      const bool swapped = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
      if (swapped) row[j] = std::min(row[j], before_last[j - 2] + 1);
    }
  }
  return row[b.size()];
}

bool is_near(std::string_view name, std::string_view candidate) {
  const std::size_t longer = std::max(name.size(), candidate.size());
  const std::size_t shorter = std::min(name.size(), candidate.size());
  if (longer > longest_compared) return false;
  if (shorter >= 2 && 2 * shorter >= longer && (name.starts_with(candidate) || candidate.starts_with(name)))
    return true;
  const std::size_t most = longer <= 4 ? 1 : longer <= 8 ? 2 : 3;
  // Each of them is at least one edit: most pairs of words end here.
  if (longer - shorter > most) return false;
  const auto edits = static_cast<std::size_t>(edit_distance(name, candidate));
  return edits <= most && 2 * edits < longer;
}

std::string did_you_mean(std::string_view name, const std::vector<std::string>& candidates) {
  const std::string* nearest = nullptr;
  int least = 0;
  for (const std::string& candidate : candidates) {
    if (!is_near(name, candidate)) continue;
    const int distance = edit_distance(name, candidate);
    if (nearest == nullptr || distance < least) {
      nearest = &candidate;
      least = distance;
    }
  }
  return nearest == nullptr ? "" : "; did you mean \"" + *nearest + "\"?";
}

std::string did_you_mean_or_list(std::string_view name, const std::vector<std::string>& candidates) {
  constexpr std::size_t most_listed = 12;
  std::string suggestion = did_you_mean(name, candidates);
  if (!suggestion.empty()) return suggestion;
  if (candidates.empty()) return "; there is none here";
  std::vector<std::string> listed = candidates;
  if (candidates.size() > most_listed) {
    std::vector<std::pair<int, std::size_t>> order;
    for (std::size_t i = 0; i < candidates.size(); ++i) {
      const bool is_long = std::max(name.size(), candidates[i].size()) > longest_compared;
      order.emplace_back(is_long ? std::numeric_limits<int>::max() : edit_distance(name, candidates[i]), i);
    }
    std::partial_sort(order.begin(), order.begin() + most_listed, order.end());
    listed.clear();
    for (std::size_t i = 0; i < most_listed; ++i) listed.push_back(candidates[order[i].second]);
  }
  std::string text = "; known here: ";
  for (std::size_t i = 0; i < listed.size(); ++i) text += (i == 0 ? "" : ", ") + listed[i];
  if (listed.size() < candidates.size()) {
    text += " and " + std::to_string(candidates.size() - listed.size()) + " more";
  }
  return text;
}

}  // namespace poise
