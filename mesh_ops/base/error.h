#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>

namespace rebake {

/// Base class of errors whose message is shown to the user.
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A file or folder cannot be used; the message starts with its path.
class FileError : public Error {
 public:
  FileError(const std::filesystem::path& path, const std::string& message) : Error(path.string() + ": " + message) {}
};

/// A field of an edit, script line or option has an invalid value; the message starts with the field's name.
class FieldError : public Error {
 public:
  FieldError(const std::string& field, const std::string& message) : Error("field \"" + field + "\": " + message) {}
};

/// An edit cannot be applied to this scene (missing node, locked node, empty selection).
class EditError : public Error {
 public:
  using Error::Error;
};

/// The machine lacks a resource, such as OpenGL or GPU memory.
class DeviceError : public Error {
 public:
  using Error::Error;
};

/// The user cancelled the operation.
class Cancelled : public Error {
 public:
  Cancelled() : Error("cancelled") {}
};

}  // namespace rebake
