// Titles of the steps in the history.
#include "editor/gui/state/titles.h"

#include "editor/edits/scene_change.h"
#include "mesh_ops/deform/deform_object.h"
#include "tests/support/document_fixture.h"

namespace rebake::test {
namespace {

class Titles : public DocumentTest {
 protected:
  Titles() {
    for (const char* name : {"a", "b"})
      act(document_, nlohmann::json{{"op", "import"}, {"path", path("sources/ball").string()}, {"as", name}});
  }
  std::string title_after(const char* edit) {
    const Scene before = document_.scene();
    act(document_, edit);
    return title_of({document_.history().edits().back()}, before, document_.scene());
  }
  Document document_;
};

TEST_F(Titles, NameNodesWithSelectedTriangles) {
  EXPECT_EQ(title_after(R"({"op": "select", "all": true})"), "Selected 512 triangles in a and b");
  EXPECT_EQ(title_after(R"({"op": "select", "node": "b", "mode": "remove", "all": true})"),
            "Deselected 256 triangles in b");
  EXPECT_EQ(title_after(R"({"op": "select", "node": "b", "all": true})"), "Selected 256 triangles in b");
  EXPECT_EQ(title_after(R"({"op": "select", "mode": "remove", "node": "a", "all": true})"),
            "Deselected 256 triangles in a");
  EXPECT_EQ(title_after(R"({"op": "delete"})"), "Deleted 256 triangles of b");
}

// Also where the selection was so before.
TEST_F(Titles, CountAllThatASelectionHolds) {
  const auto half = [](const std::string& more) {
    return R"({"op": "select", "half_space": {"point": [0, 0, 0], "normal": [0, 1, 0]})" + more + "}";
  };
  EXPECT_EQ(title_after(half(R"(, "node": "a")").c_str()), "Selected 128 triangles in a");
  EXPECT_EQ(title_after(half("").c_str()), "Selected 256 triangles in a and b (+128)");
  EXPECT_EQ(title_after(R"({"op": "select", "node": "b", "all": true})"), "Selected 256 triangles in b (+128)");
  EXPECT_EQ(title_after(R"({"op": "select", "node": "b", "mode": "remove", "all": true})"),
            "Deselected 256 triangles in b");
  EXPECT_EQ(title_after(half("").c_str()), "Selected 256 triangles in a and b (+128)");
}

TEST_F(Titles, DoNotTakeRemovedNodesForTheSelection) {
  act(document_, R"({"op": "hide", "node": "b"})");
  const std::vector<Edit> hidden = {document_.history().edits().back()};
  act(document_, R"({"op": "remove", "node": "b"})");
  EXPECT_EQ(title_of(hidden, document_.scene()), "Hid a node that was removed later");
}

TEST_F(Titles, CountTrianglesThatDeformationsMoved) {
  act(document_, R"({"op": "select", "node": "b", "box": {"min": [0, 0.5, 0], "max": [1, 1, 1]}, "frame": "bounds"})");
  EXPECT_EQ(title_after(R"({"op": "bend", "node": "b", "degrees": 20})"), "Bent by 20°: b");
  const std::string part = title_after(R"({"op": "bend", "node": "b", "degrees": 20, "selection": true,
      "box": {"min": [0, 0, 0], "max": [0.5, 1, 1]}, "frame": "bounds"})");
  const std::size_t selected = count(*find(document_.scene(), "b")->selection);
  ASSERT_TRUE(part.starts_with("Bent by 20°: ") && part.ends_with(" triangles of b")) << part;
  EXPECT_LT(std::stoul(part.substr(std::string("Bent by 20°: ").size())), selected) << part;
}

// All of a lies below `from`, and b above.
TEST_F(Titles, NameOnlyObjectsThatALimitedDeformationMoves) {
  act(document_, R"({"op": "transform", "node": "b", "translate": [0, 10, 0]})");
  act(document_, R"({"op": "select", "all": true})");
  const auto before = find(document_.scene(), "a")->object;
  EXPECT_EQ(title_after(R"({"op": "twist", "degrees": 30, "origin": [0, 0, 0], "from": 5, "to": 20})"),
            "Twisted by 30°: 256 triangles of b");
  EXPECT_EQ(find(document_.scene(), "a")->object, before);
  EXPECT_EQ(title_after(R"({"op": "twist", "degrees": 30, "origin": [0, 0, 0], "from": 50, "to": 60})"),
            "Twisted by 30°: 0 triangles");
}

// As the faces in the foot plane of a twist.
TEST(SceneChange, CountsTrianglesThatOnlyRotate) {
  const auto object = made_object();
  const auto turn = [](const std::vector<Vec3>& points) {
    const Mat3 quarter{{0, 0, 1}, {0, 1, 0}, {-1, 0, 0}};
    return DeformedPoints{points, std::vector<Mat3>(points.size(), quarter), {}};
  };
  const TriangleSet all(object->triangle_count(), 1);
  const auto turned = deformed(*object, Affine::Identity(), all, 0, turn).object;
  const SceneChange change = change_between(scene_of(object, "ball"), scene_of(turned, "ball"));
  EXPECT_EQ(change.moved, object->triangle_count());
  EXPECT_EQ(change.with_moved, std::vector<std::string>{"ball"});
}

TEST_F(Titles, CountOnlyWhatATransformMoves) {
  act(document_, R"({"op": "select", "node": "b", "all": true})");
  EXPECT_EQ(title_after(R"({"op": "transform", "node": "b", "selection": true})"), "Moved 0 triangles");
}

TEST_F(Titles, NameTheNodesThatEditsWorkOn) {
  EXPECT_EQ(title_after(R"({"op": "group", "nodes": ["a"], "as": "g"})"), "Grouped a as g");
  EXPECT_EQ(title_after(R"({"op": "duplicate", "node": "g"})"), "Copied g as g.2");
  EXPECT_EQ(title_after(R"({"op": "reorder", "node": "b", "parent": "g", "index": 0})"), "Moved in the outline: b");
}

TEST_F(Titles, CountWhatAnEditChanged) {
  act(document_, R"({"op": "select", "node": "b", "box": {"min": [0, 0.5, 0], "max": [1, 1, 1]}, "frame": "bounds"})");
  const std::string part = std::to_string(count(*find(document_.scene(), "b")->selection)) + " triangles";
  EXPECT_EQ(title_after(R"({"op": "transform", "node": "b", "selection": true, "translate": [1, 0, 0]})"),
            "Moved " + part + " of b");
  EXPECT_EQ(title_after(R"({"op": "transform", "node": "b", "translate": [1, 0, 0]})"), "Moved b");
  EXPECT_EQ(title_after(R"({"op": "bend", "degrees": 20})"), "Bent by 20°: " + part + " of b");
  EXPECT_EQ(
      title_after(R"({"op": "cage", "lattice": [1, 1, 1], "moves": [{"points": [0, 1], "translate": [0, 1, 0]}]})"),
      "Moved 2 cage points of b");
  // Points that stay do not count; those that turn are not counted.
  EXPECT_EQ(title_after(R"({"op": "cage", "lattice": [1, 1, 1],
      "moves": [{"points": [0], "translate": [0, 1, 0]}, {"points": [1]}]})"),
            "Moved 1 cage point of b");
  EXPECT_EQ(title_after(R"({"op": "cage", "lattice": [1, 1, 1],
      "moves": [{"points": [0, 1], "translate": [0, 1, 0]}, {"points": [1], "translate": [0, 0, 1]}]})"),
            "Deformed by a cage: " + part + " of b");
  EXPECT_EQ(title_after(R"({"op": "separate", "node": "b", "as": "c"})"), "Separated " + part + " as c");
  EXPECT_EQ(
      title_after(R"({"op": "erase", "node": "a", "box": {"min": [0, 0, 0], "max": [1, 1, 1]}, "frame": "bounds"})"),
      "Erased in a");
}

}  // namespace
}  // namespace rebake::test
