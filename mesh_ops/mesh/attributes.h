#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "mesh_ops/base/types.h"

namespace rebake {

/// Immutable array of one value per element (vertex or face). Elements without an explicit value have the neutral one.
class Attribute {
 public:
  virtual ~Attribute() = default;

  virtual std::size_t size() const = 0;
  virtual std::uint64_t memory() const = 0;  ///< bytes
  /// Values of `elements`, in this order; null if all are neutral.
  virtual std::shared_ptr<const Attribute> picked(const std::vector<std::uint32_t>& elements) const = 0;
  /// A copy padded with `before` neutral values in front and `behind` neutral values at the end.
  virtual std::shared_ptr<const Attribute> padded(std::size_t before, std::size_t behind) const = 0;
  /// Whether `other` has the same type and values.
  virtual bool equals(const Attribute& other) const = 0;
  /// Concatenation with `other`. Throws std::bad_cast if it has another type.
  virtual std::shared_ptr<const Attribute> followed_by(const Attribute& other) const = 0;

 protected:
  Attribute() = default;
  Attribute(const Attribute&) = default;
  Attribute& operator=(const Attribute&) = default;
};

/// An Attribute with values of type T.
template <class T>
class Values final : public Attribute {
 public:
  explicit Values(std::vector<T> values) : values_(std::move(values)) {}

  /// Zero if T has T::Zero(), else T{}.
  static T neutral() {
    if constexpr (requires { T::Zero(); })
      return T::Zero();
    else
      return T{};
  }
  /// Null if all values are neutral.
  static std::shared_ptr<const Attribute> of(std::vector<T> values) {
    if (std::all_of(values.begin(), values.end(), [](const T& value) { return value == neutral(); })) return nullptr;
    return std::make_shared<const Values>(std::move(values));
  }

  const std::vector<T>& get() const { return values_; }
  std::size_t size() const override { return values_.size(); }
  std::uint64_t memory() const override { return values_.size() * sizeof(T); }
  std::shared_ptr<const Attribute> picked(const std::vector<std::uint32_t>& elements) const override {
    std::vector<T> values;
    values.reserve(elements.size());
    for (const std::uint32_t element : elements) values.push_back(values_[element]);
    return of(std::move(values));
  }
  std::shared_ptr<const Attribute> padded(std::size_t before, std::size_t behind) const override {
    std::vector<T> values(before, neutral());
    values.insert(values.end(), values_.begin(), values_.end());
    values.resize(values.size() + behind, neutral());
    return std::make_shared<const Values>(std::move(values));
  }
  bool equals(const Attribute& other) const override {
    const auto* same = dynamic_cast<const Values*>(&other);
    return same != nullptr && same->get() == values_;
  }
  std::shared_ptr<const Attribute> followed_by(const Attribute& other) const override {
    std::vector<T> values = values_;
    const std::vector<T>& more = dynamic_cast<const Values&>(other).get();
    values.insert(values.end(), more.begin(), more.end());
    return std::make_shared<const Values>(std::move(values));
  }

 private:
  std::vector<T> values_;
};

/// Attributes by name. Code that splits, joins or duplicates elements carries all attributes along without knowing
/// them. A name has the same type everywhere.
class Attributes {
 public:
  using Shared = std::shared_ptr<const Attribute>;

  /// Null if no attribute has that name.
  Shared shared(const std::string& name) const;
  /// Values of an attribute; null if no attribute has that name. Throws std::bad_cast if it has another type.
  template <class T>
  const std::vector<T>* find(const std::string& name) const {
    const Shared attribute = shared(name);
    return attribute ? &dynamic_cast<const Values<T>&>(*attribute).get() : nullptr;
  }
  /// A copy with one attribute replaced, or removed if `attribute` is null.
  Attributes with(const std::string& name, Shared attribute) const;
  /// Attributes of `elements`, in this order.
  Attributes picked(const std::vector<std::uint32_t>& elements) const;
  /// Attributes of `count` elements, followed by `other_count` elements with the attributes `other`.
  Attributes followed_by(std::size_t count, const Attributes& other, std::size_t other_count) const;

  /// Whether both have the same names and values.
  bool has_values(const Attributes& other) const {
    return std::equal(entries_.begin(), entries_.end(), other.entries_.begin(), other.entries_.end(),
                      [](const auto& a, const auto& b) {
                        return a.first == b.first && (a.second == b.second || a.second->equals(*b.second));
                      });
  }

  auto begin() const { return entries_.begin(); }
  auto end() const { return entries_.end(); }
  /// Whether both share the same arrays.
  bool operator==(const Attributes&) const = default;

 private:
  std::vector<std::pair<std::string, Shared>> entries_;  ///< sorted by name
};

}  // namespace rebake
