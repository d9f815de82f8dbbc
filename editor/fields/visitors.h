#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "editor/fields/codec.h"
#include "editor/fields/field_info.h"
#include "mesh_ops/base/error.h"

namespace rebake {

/// An absent value is written as null, which FieldWriter omits.
template <class T>
struct Codec<std::optional<T>> {
  static FieldType type() { return Codec<T>::type(); }
  static std::optional<T> read(const nlohmann::json& value, const Scene& scene) { return Codec<T>::read(value, scene); }
  static nlohmann::json write(const std::optional<T>& value) {
    return value ? Codec<T>::write(*value) : nlohmann::json();
  }
};

/// Field visitor that reads a struct from one JSON object. Absent fields keep their defaults. Node names are looked up
/// in `scene`.
class FieldReader {
 public:
  FieldReader(const nlohmann::json& object, const Scene& scene) : object_(object), scene_(scene) {}

  template <class T>
  void operator()(const char* name, T& value, Need need, const char* /*help*/, Unit /*unit*/ = Unit::none) {
    known_.emplace_back(name);
    const nlohmann::json* found = find(name, need);
    if (found == nullptr) return;
    try {
      value = Codec<T>::read(*found, scene_);
    } catch (const FieldError&) {
      throw;
    } catch (const Error& error) {
      throw FieldError(name, error.what());
    }
  }
  /// Call after all fields are visited. Throws FieldError for an unknown field, with the most similar known one as a
  /// suggestion, and for a missing required field.
  void finish() const;

 private:
  // The field's value; null if it is absent.
  const nlohmann::json* find(const char* name, Need need);

  const nlohmann::json& object_;
  const Scene& scene_;
  std::vector<std::string> known_{"op"}, missing_;
};

/// Field visitor that writes a struct to a JSON object, without null values.
class FieldWriter {
 public:
  explicit FieldWriter(nlohmann::json& object) : object_(object) {}
  template <class T>
  void operator()(const char* name, const T& value, Need /*need*/, const char* /*help*/, Unit /*unit*/ = Unit::none) {
    put(name, Codec<T>::write(value));
  }

 private:
  void put(const char* name, nlohmann::json written);
  nlohmann::json& object_;
};

/// Field visitor that lists fields with types, defaults and help.
class FieldLister {
 public:
  explicit FieldLister(std::vector<FieldInfo>& lines) : lines_(lines) {}
  template <class T>
  void operator()(const char* name, const T& value, Need need, const char* help, Unit unit = Unit::none) {
    add(name, Codec<T>::type(), Codec<T>::write(value), need, help, unit);
  }

 private:
  void add(const char* name, FieldType type, const nlohmann::json& initial, Need need, const char* help, Unit unit);
  std::vector<FieldInfo>& lines_;
};

}  // namespace rebake
