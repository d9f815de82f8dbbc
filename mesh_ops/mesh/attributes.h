#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "mesh_ops/base/types.h"

namespace rebake {

/// One value an element (a vertex or a face), immutable. Elements without a value of their own have the neutral one.
class Attribute {
 public:
  virtual ~Attribute() = default;

  virtual std::size_t size() const = 0;
  virtual std::uint64_t memory() const = 0;  ///< bytes
  /// The values of these elements, in this order; null where all of them are neutral.
  virtual std::shared_ptr<const Attribute> picked(const std::vector<std::uint32_t>& elements) const = 0;
  /// The values between so many neutral ones before and behind.
  virtual std::shared_ptr<const Attribute> padded(std::size_t before, std::size_t behind) const = 0;
  /// The values and those of another attribute of this type behind them.
  virtual std::shared_ptr<const Attribute> followed_by(const Attribute& other) const = 0;

 protected:
  Attribute() = default;
  Attribute(const Attribute&) = default;
  Attribute& operator=(const Attribute&) = default;
};

template <class T>
class Values final : public Attribute {
 public:
  explicit Values(std::vector<T> values) : values_(std::move(values)) {}

  static T neutral() {
    if constexpr (requires { T::Zero(); })
      return T::Zero();
    else
      return T{};
  }
  /// Null where all are neutral.
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
  std::shared_ptr<const Attribute> followed_by(const Attribute& other) const override {
    std::vector<T> values = values_;
    const std::vector<T>& more = dynamic_cast<const Values&>(other).get();
    values.insert(values.end(), more.begin(), more.end());
    return std::make_shared<const Values>(std::move(values));
  }

 private:
  std::vector<T> values_;
};

/// Attributes by name. What takes elements apart, puts them together or doubles them carries all of them along, and
/// knows none. A name stands for one type everywhere.
class Attributes {
 public:
  using Shared = std::shared_ptr<const Attribute>;

  /// Null where there is none of that name.
  Shared shared(const std::string& name) const;
  template <class T>
  const std::vector<T>* find(const std::string& name) const {
    const Shared attribute = shared(name);
    return attribute ? &dynamic_cast<const Values<T>&>(*attribute).get() : nullptr;
  }
  /// With another attribute of that name, or without one where it is null.
  Attributes with(const std::string& name, Shared attribute) const;
  /// Of these elements, in this order.
  Attributes picked(const std::vector<std::uint32_t>& elements) const;
  /// Of `count` elements and those of `other` behind them.
  Attributes followed_by(std::size_t count, const Attributes& other, std::size_t other_count) const;

  auto begin() const { return entries_.begin(); }
  auto end() const { return entries_.end(); }
  /// The very same values.
  bool operator==(const Attributes&) const = default;

 private:
  std::vector<std::pair<std::string, Shared>> entries_;  ///< by name
};

}  // namespace rebake
