#pragma once

#include <memory>
#include <mutex>

namespace rebake {

/// A value that is computed when it is first asked for, by whichever thread asks first, and then kept. A copy starts
/// empty: what was derived from one object does not describe another.
template <class T>
class Memo {
 public:
  Memo() = default;
  Memo(const Memo&) {}
  Memo& operator=(const Memo&) {
    const std::scoped_lock lock(mutex_);
    value_ = nullptr;
    return *this;
  }

  /// Forgets the value; it is computed again when it is wanted.
  void clear() const {
    const std::scoped_lock lock(mutex_);
    value_ = nullptr;
  }

  template <class Make>
  std::shared_ptr<const T> get(Make make) const {
    const std::scoped_lock lock(mutex_);
    if (!value_) value_ = make();
    return value_;
  }

  /// Null while there is no value, or it is being made.
  std::shared_ptr<const T> if_there() const {
    const std::unique_lock lock(mutex_, std::try_to_lock);
    return lock ? value_ : nullptr;
  }

 private:
  mutable std::mutex mutex_;
  mutable std::shared_ptr<const T> value_;
};

}  // namespace rebake
