#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "editor/fields/codec.h"
#include "editor/fields/field_line.h"
#include "mesh_ops/base/error.h"

namespace rebake {

template <class T>
struct Codec<std::optional<T>> {
  static FieldType type() { return Codec<T>::type(); }
  static std::optional<T> read(const nlohmann::json& value, const Scene& scene) { return Codec<T>::read(value, scene); }
  static nlohmann::json write(const std::optional<T>& value) {
    return value ? Codec<T>::write(*value) : nlohmann::json();
  }
};

/// Reads the fields that a struct describes from one JSON object. Node names are looked up in `scene`.
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
  /// Throws FieldError for a field that nothing has read, suggesting the nearest known one, and for a required field
  /// that is missing. To be called when all fields are read.
  void finish() const;

 private:
  // Null when it is left out.
  const nlohmann::json* find(const char* name, Need need);

  const nlohmann::json& object_;
  const Scene& scene_;
  std::vector<std::string> known_{"op"}, missing_;
};

/// Writes all fields that have a value.
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

/// Lists fields, for help and forms.
class FieldLister {
 public:
  explicit FieldLister(std::vector<FieldLine>& lines) : lines_(lines) {}
  template <class T>
  void operator()(const char* name, const T& value, Need need, const char* help, Unit unit = Unit::none) {
    add(name, Codec<T>::type(), Codec<T>::write(value), need, help, unit);
  }

 private:
  void add(const char* name, FieldType type, const nlohmann::json& initial, Need need, const char* help, Unit unit);
  std::vector<FieldLine>& lines_;
};

}  // namespace rebake
