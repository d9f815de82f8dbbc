// Titles of the steps in the history.
#include "editor/gui/state/titles.h"

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

}  // namespace
}  // namespace rebake::test
