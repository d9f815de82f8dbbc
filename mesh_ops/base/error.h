#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>

namespace rebake {

/// Base of everything Rebake throws on purpose; the message is meant for people.
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Something is wrong with a file or folder; the message starts with its path.
class FileError : public Error {
 public:
  FileError(const std::filesystem::path& path, const std::string& message) : Error(path.string() + ": " + message) {}
};

/// A field of an edit, script line or option does not hold what it should; the message starts with its name.
class FieldError : public Error {
 public:
  FieldError(const std::string& field, const std::string& message) : Error("field \"" + field + "\": " + message) {}
};

/// An edit cannot be carried out on this scene (missing node, locked node, empty selection).
class EditError : public Error {
 public:
  using Error::Error;
};

/// The machine lacks something: no OpenGL, no memory on the GPU.
class DeviceError : public Error {
 public:
  using Error::Error;
};

/// The person asked to stop.
class Cancelled : public Error {
 public:
  Cancelled() : Error("cancelled") {}
};

}  // namespace rebake
