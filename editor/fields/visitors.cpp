#include "editor/fields/visitors.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <numeric>

namespace rebake {

using nlohmann::json;

const json* FieldReader::find(const char* name, Need need) {
  const auto found = object_.find(name);
  if (found != object_.end()) return &*found;
  if (need == Need::required) missing_.emplace_back(name);
  return nullptr;
}

void FieldWriter::put(const char* name, json written) {
  if (!written.is_null()) object_[name] = std::move(written);
}

void FieldLister::add(const char* name, FieldType type, const json& initial, Need need, const char* help, Unit unit) {
  lines_.push_back({name, std::move(type), need == Need::required || initial.is_null() ? "" : initial.dump(), help,
                    unit, need == Need::required});
}

void FieldReader::finish() const {
  for (const auto& [name, value] : object_.items()) {
    if (std::find(known_.begin(), known_.end(), name) != known_.end()) continue;
    // Prefers the name of a missing required field as the suggestion.
    const std::string meant = nearest_word(name, missing_), near = meant.empty() ? nearest_word(name, known_) : meant;
    throw FieldError(name, near.empty()
                               ? fmt::format("is not a known field; its fields are {}", fmt::join(known_, ", "))
                               : fmt::format("is not a known field; did you mean \"{}\"?", near));
  }
  if (!missing_.empty()) throw FieldError(missing_.front(), "is missing");
}

std::string nearest_word(const std::string& word, const std::vector<std::string>& known) {
  std::string best;
  // Exclusive maximum of the distance: about a third of a long word's letters, less than half of a short word's, one
  // letter of two.
  std::size_t best_distance = std::max(std::size_t{2}, std::min(word.size() / 3 + 2, (word.size() + 1) / 2));
  for (const std::string& candidate : known) {
    std::vector<std::size_t> row(candidate.size() + 1);
    std::iota(row.begin(), row.end(), std::size_t{0});
    for (std::size_t i = 1; i <= word.size(); ++i) {
      std::size_t diagonal = row[0];
      row[0] = i;
      for (std::size_t j = 1; j <= candidate.size(); ++j) {
        const std::size_t above = row[j];
        row[j] = std::min({above + 1, row[j - 1] + 1, diagonal + (word[i - 1] == candidate[j - 1] ? 0U : 1U)});
        diagonal = above;
      }
    }
    if (row.back() < best_distance) {
      best_distance = row.back();
      best = candidate;
    }
  }
  return best;
}

}  // namespace rebake
