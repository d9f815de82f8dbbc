#include "editor/python/stub.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "editor/edits/edit.h"
#include "editor/fields/field_line.h"

namespace rebake {

std::string python_name(std::string_view name) {
  return name == "as" || name == "from" || name == "import" ? fmt::format("{}_", name) : std::string(name);
}

namespace {

std::string python_value(const nlohmann::json& value) {
  if (value.is_null()) return "None";
  if (value.is_boolean()) return value.get<bool>() ? "True" : "False";
  return value.dump();
}

// Parameters of one edit in Python's order (required ones first), and a help line per field.
struct Signature {
  std::vector<std::string> required, optional, lines;
  explicit Signature(const std::vector<FieldLine>& fields) {
    for (const FieldLine& field : fields) {
      const std::string name = python_name(field.name);
      if (field.required)
        required.push_back(fmt::format("{}: {}", name, field.type.python));
      else if (field.initial.empty())
        optional.push_back(fmt::format("{}: {} | None = None", name, field.type.python));
      else
        optional.push_back(
            fmt::format("{}: {} = {}", name, field.type.python, python_value(nlohmann::json::parse(field.initial))));
      const std::string help =
          field.unit == Unit::none ? field.help : fmt::format("{} ({})", field.help, to_string(field.unit));
      lines.push_back(fmt::format("{}: {}", name, help));
    }
  }
};

constexpr const char* head = R"(# Written by rebake.python_stub(); the edits are those of the one table.
"""Edit and compose baked NeRF scenes (MobileNeRF format).

Lengths are in scene units, angles in degrees, colours display values from 0 to 1. Names and fields are those of scripts.
"""
from os import PathLike
from typing import Any, Callable, Literal, Sequence, TypedDict

import numpy as np
from numpy.typing import NDArray

Vector = Sequence[float] | NDArray[np.floating[Any]]
Node = str | int
Progress = Callable[[str, float], object]
class AxisAngle(TypedDict):
    axis: Vector
    degrees: float
Rotation = AxisAngle | Sequence[float]
class Box(TypedDict):
    min: Vector
    max: Vector
class Sphere(TypedDict):
    center: Vector
    radius: float
class HalfSpace(TypedDict):
    point: Vector
    normal: Vector
class Brush(TypedDict):
    points: Sequence[Sequence[float]]
    radius: float
class Camera(TypedDict, total=False):
    eye: Vector
    target: Vector
    up: Vector
    fov: float
    ortho_height: float
    near: float
    far: float

class Error(RuntimeError):
    """Base of everything that Rebake raises on purpose."""
class FileError(Error):
    """Something is wrong with a file or folder; the message starts with its path."""
class FieldError(Error):
    """A field does not hold what it should; the message starts with its name."""
class EditError(Error):
    """An edit cannot be carried out on this scene."""
class DeviceError(Error):
    """The machine lacks something: no OpenGL, no memory on the GPU."""

def open(path: str | PathLike[str], axes: Literal["360", "forward"] = "360",
         progress: Progress | None = None, sources: dict[str, str | list[str]] = {}) -> Document:
    """Opens a MobileNeRF folder, a Rebake scene or a project (.rebake). `sources` maps moved folders of a project to
    their new paths."""
def recover(journal: str | PathLike[str], sources: dict[str, str | list[str]] = {},
            progress: Progress | None = None) -> Document:
    """The work that a journal kept; goes on writing it. `sources`: where moved ones lie now, old path to new."""
def move_by_cage(points: NDArray[np.float64], vertices: NDArray[np.float64], faces: NDArray[np.uint32],
                 moved: NDArray[np.float64], coordinates: Literal["mean_value", "green", "harmonic"] = "mean_value",
                 resolution: int = 32) -> NDArray[np.float64]:
    """Where points (n × 3) go when a closed cage's vertices move to `moved`."""
def wrap(points: NDArray[np.float64], faces: NDArray[np.uint32],
         coarseness: float = 0.1) -> tuple[NDArray[np.float64], NDArray[np.uint32]]:
    """A closed cage around triangles: its vertices and faces. Coarseness is a share of their size, 0.005 to 0.5."""
def python_stub() -> str:
    """This text."""

class Document:
    """A scene with its history. An edit that raises leaves everything as it was."""
    progress: Progress | None
    """Called, ten times a second at most, with what is done and its share while something long is; what it raises stops
    that, as Ctrl+C does, and nothing is changed."""
    def __init__(self) -> None: ...
    @property
    def nodes(self) -> list[dict[str, Any]]:
        """Every node: id, name, parent, visible, locked, triangles, to_world (4×4)."""
    def edit(self, edit: dict[str, Any]) -> None:
        """Carries out one edit, given as a line of a script."""
    def edits(self) -> list[dict[str, Any]]:
        """What was done, as lines of a script; nodes by number."""
    def undo(self) -> bool:
        """False where there is nothing to undo."""
    def redo(self) -> bool:
        """False where there is nothing to redo."""
    def keep_journal(self, path: str | PathLike[str]) -> None:
        """From here on every edit is on the disk before it returns."""
    def discard_journal(self) -> None: ...
    def save(self, path: str | PathLike[str]) -> None:
        """Writes a project (.rebake), or a scene folder that keeps every node."""
    def export(self, path: str | PathLike[str], layout: Literal["split", "chunked", "unsplit"] | None = None,
               format: Literal["mobilenerf", "rebake"] = "mobilenerf", plain: bool = False,
               width: int | Literal["auto"] = "auto",
               way: Literal["keep", "train", "new", "side_by_side"] | None = None, keep: str = "auto",
               psnr: float | None = None, seconds: float = 0, report: str | PathLike[str] = "") -> list[str]:
        """Writes the MobileNeRF format or another; returns what the result cannot hold or was converted, and with
        plain (one folder for any scene) what was measured."""
    def render(self, width: int = 800, height: int = 800, samples: int = 4, camera: Camera | None = None,
               view: str = "") -> NDArray[np.uint8]:
        """A picture, height × width × 3; without camera and view, one that frames the scene."""
    def selection(self, node: Node) -> NDArray[np.bool_]:
        """Which of an object's triangles are selected, in the order of faces() set by set."""
    def select_mask(self, node: Node, mask: NDArray[np.bool_],
                    mode: Literal["set", "add", "remove", "intersect"] = "set") -> dict[str, NDArray[np.bool_]]:
        """Selects an object's triangles by a mask, as selection() gives one; recorded as select_triangles."""
    def vertices(self, node: Node, texture_set: int = 0) -> NDArray[np.float64]:
        """Positions in the object's own space, n × 3; a read-only view, nothing is copied."""
    def uvs(self, node: Node, texture_set: int = 0) -> NDArray[np.float64]:
        """Texture coordinates, n × 2, v up; a read-only view."""
    def faces(self, node: Node, texture_set: int = 0) -> NDArray[np.uint32]:
        """Vertex numbers, n × 3; a read-only view."""
    def tiles(self, node: Node, texture_set: int = 0) -> list[list[NDArray[np.uint8]]]:
        """The texels, 256 × 256 × 8 a tile (feat0 RGBA, feat1 RGBA), by row and column; read-only, unpacked by each call."""
    def texture(self, node: Node, texture_set: int = 0) -> NDArray[np.uint8]:
        """The same in one piece, height × width × 8; a copy."""
)";

// Source of a typed method for an edit, indented as in a class. `last`: a further parameter, such as **unknown.
std::string method(const EditType& edit, const char* last = nullptr) {
  const Signature signature(edit.fields());
  std::vector<std::string> parameters = signature.required;
  parameters.insert(parameters.end(), signature.optional.begin(), signature.optional.end());
  std::string list = parameters.empty() ? "" : fmt::format(", *, {}", fmt::join(parameters, ", "));
  if (last != nullptr) list += fmt::format(", {}", last);
  return fmt::format("    def {}(self{}) -> {}:\n        \"\"\"{}\n\n        {}\n        \"\"\"\n",
                     python_name(edit.op), list, edit.selects ? "dict[str, NDArray[np.bool_]]" : "None", edit.help,
                     fmt::join(signature.lines, "\n        "));
}

}  // namespace

std::string python_stub() {
  std::string out = head;
  for (const EditType* type : edit_types()) out += method(*type);
  return out;
}

std::string python_methods() {
  std::string out = "from __future__ import annotations\nclass Edits:\n";
  for (const EditType* type : edit_types()) {
    std::string fields;
    for (const FieldLine& field : type->fields())
      fields += fmt::format("\"{}\": {}, ", field.name, python_name(field.name));
    // Unknown fields are passed on, so that the error can suggest a similar name.
    out += method(*type, "**unknown") +
           fmt::format("        return self._edit(\"{}\", {{{}**unknown}})\n", type->op, fields);
  }
  return out;
}

}  // namespace rebake
