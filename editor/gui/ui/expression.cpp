#include "editor/gui/ui/expression.h"

#include <charconv>
#include <cmath>
#include <numbers>

namespace rebake {

namespace {

// Recursive descent parser of the grammar
// sum = product {± product}, product = factor {*/ factor}, factor = ± factor | (sum) | pi | number.
class Reader {
 public:
  explicit Reader(std::string_view text) : rest_(text) {}

  std::optional<double> whole() {
    const std::optional<double> value = sum();
    skip();
    return value && rest_.empty() && std::isfinite(*value) ? value : std::nullopt;
  }

 private:
  void skip() {
    while (!rest_.empty() && rest_.front() == ' ') rest_.remove_prefix(1);
  }
  bool take(char c) {
    skip();
    if (rest_.empty() || rest_.front() != c) return false;
    rest_.remove_prefix(1);
    return true;
  }
  std::optional<double> sum() {
    std::optional<double> left = product();
    while (left) {
      const double sign = take('+') ? 1 : take('-') ? -1 : 0;
      if (sign == 0) break;
      const std::optional<double> right = product();
      left = right ? std::optional(*left + sign * *right) : std::nullopt;
    }
    return left;
  }
  std::optional<double> product() {
    std::optional<double> left = factor();
    while (left) {
      const bool times = take('*'), over = !times && take('/');
      if (!times && !over) break;
      const std::optional<double> right = factor();
      left = right ? std::optional(times ? *left * *right : *left / *right) : std::nullopt;
    }
    return left;
  }
  std::optional<double> factor() {
    constexpr int deepest = 100;
    if (++depth_ > deepest) return std::nullopt;
    if (take('-')) {
      const std::optional<double> value = factor();
      return value ? std::optional(-*value) : std::nullopt;
    }
    if (take('+')) return factor();
    if (take('(')) {
      const std::optional<double> value = sum();
      return value && take(')') ? value : std::nullopt;
    }
    skip();
    if (rest_.starts_with("pi")) {
      rest_.remove_prefix(2);
      return std::numbers::pi;
    }
    double value = 0;
    const auto [end, error] = std::from_chars(rest_.data(), rest_.data() + rest_.size(), value);
    if (error != std::errc()) return std::nullopt;
    rest_.remove_prefix(static_cast<std::size_t>(end - rest_.data()));
    return value;
  }

  std::string_view rest_;
  int depth_ = 0;
};

}  // namespace

std::optional<double> evaluated(std::string_view text) { return Reader(text).whole(); }

}  // namespace rebake
