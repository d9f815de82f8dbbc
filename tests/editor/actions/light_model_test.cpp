// Models of light transfer: training, use, removal and refusals.
#include "editor/actions/light_model.h"

#include <gtest/gtest.h>

#include <map>
#include <memory>

#include "editor/edits/shared_result_cache.h"
#include "mesh_ops/base/files.h"
#include "tests/support/power_loss.h"
#include "tests/support/script_fixture.h"

namespace rebake::test {
namespace {

class MemoryCache final : public ResultCache {
 public:
  std::optional<std::string> find(const std::string& key) override {
    const auto found = entries.find(key);
    return found == entries.end() ? std::nullopt : std::optional(found->second);
  }
  void keep(const std::string& key, std::string_view bytes) override {
    if (!full) entries[key] = bytes;
  }
  bool full = false;
  std::map<std::string, std::string> entries;
};

class LightModel : public Script {
 protected:
  LightModel() {
    session.say = [this](const std::string& line) { said_ += line + "\n"; };
    set_result_cache(cache_);
  }
  ~LightModel() override { set_result_cache(nullptr); }
  std::string said() { return std::exchange(said_, ""); }
  // Stored entries that are models.
  std::size_t models() const {
    std::size_t count = 0;
    for (const auto& [key, bytes] : cache_->entries) count += is_transfer_model(bytes) ? 1 : 0;
    return count;
  }
  std::shared_ptr<MemoryCache> cache_ = std::make_shared<MemoryCache>();
  const std::string bend = R"({"op": "bend", "node": "ball", "degrees": 60})"
                           "\n";
  const std::string few = R"("poses": 12, "rays": 32)";

 private:
  std::string said_;
};

TEST_F(LightModel, IsTrainedOnTheHistoryUsedForgottenAndLoaded) {
  run(import + bend);
  run(R"({"op": "train_light", "out": "{here}/m.light", )" + few + "}");
  const std::string facts = said();
  EXPECT_NE(facts.find("poses       12 of"), std::string::npos) << facts;
  EXPECT_NE(facts.find("\"degrees\":60"), std::string::npos) << facts;
  const TransferModel model = read_light_model(folder_.path() / "m.light");
  EXPECT_EQ(models(), worth_using(model) ? 1U : 0U) << facts;
  EXPECT_EQ(session.document.history().edits().size(), 2U) << "training is no step of the history";
  run(R"({"op": "use_light_model", "model": "{here}/m.light"})");
  EXPECT_NE(said().find("drags of \"ball\" now use the model"), std::string::npos);
  EXPECT_EQ(models(), 1U);
  run(R"({"op": "forget_light_model"})");
  EXPECT_NE(said().find("rotate the transfer again"), std::string::npos);
  EXPECT_EQ(models(), 0U);
  run(R"({"op": "forget_light_model", "node": "ball"})");
  EXPECT_NE(said().find("has no trained model"), std::string::npos);
}

TEST_F(LightModel, FailedWritesAreReportedAndLoseNoModel) {
  run(import + bend);
  const std::string train = R"({"op": "train_light", "out": "{here}/m.light", )" + few + "}";
  run(train);
  ASSERT_EQ(models(), 1U) << said();
  run(R"({"op": "forget_light_model"})");
  {
    PowerLoss disk;
    disk.fail_at(0, ENOSPC);
    const ReplacedFileCalls full(disk);
    expect_error(train, "m.light");
  }
  EXPECT_EQ(models(), 1U);
  run(R"({"op": "forget_light_model"})");
  cache_->full = true;
  expect_error(R"({"op": "use_light_model", "model": "{here}/m.light"})", "cannot be stored in the result cache");
  said();
  std::filesystem::remove(folder_.path() / "m.light");
  run(train);
  EXPECT_NE(said().find("do not use the model: the model cannot be stored"), std::string::npos);
  EXPECT_TRUE(std::filesystem::exists(folder_.path() / "m.light"));
}

TEST_F(LightModel, OfAnEditedObjectIsThatOfTheObjectAsRead) {
  run(import);
  run(R"({"op": "train_light", "edits": [{"op": "bend", "degrees": 60}], "out": "{here}/before.light", )" + few + "}");
  run(bend);
  run(R"({"op": "train_light", "edits": [{"op": "bend", "degrees": 60}], "out": "{here}/after.light", )" + few + "}");
  const TransferModel before = read_light_model(folder_.path() / "before.light"),
                      after = read_light_model(folder_.path() / "after.light");
  EXPECT_EQ(before.body, after.body);
  EXPECT_EQ(before.keys, after.keys);
  EXPECT_EQ(before.learned.held_back_error, after.learned.held_back_error);
}

TEST_F(LightModel, RefusesWhatCannotBeTrained) {
  run(import);
  expect_error(R"({"op": "train_light"})", "bend it first");
  // The selection may be another one by now.
  run(R"({"op": "select", "all": true}
{"op": "bend", "node": "ball", "selection": true, "degrees": 20})");
  expect_error(R"({"op": "train_light", "node": "ball"})", "moves the triangles that were selected then");
  run(R"({"op": "undo"}
{"op": "undo"})");
  expect_error(R"({"op": "train_light", "edits": []})", "must be a list of edits");
  expect_error(R"({"op": "train_light", "edits": [{"op": "bnd"}]})", "bnd");
  expect_error(R"({"op": "train_light", "edits": [{"op": "remove", "node": "ball"}]})", "removes the object");
  expect_error(R"({"op": "train_light", "edits": [{"op": "bend", "degrees": 9}], "poses": 3})", "poses");
  expect_error(R"({"op": "train_light", "edits": [{"op": "bend", "degrees": 9}], "way": "deep"})",
               "linear, net or published");
  expect_error(R"({"op": "train_light", "edits": [{"op": "bend", "degrees": 9}], "way": "net", "channels": 9})",
               "multiple of 8");
}

TEST_F(LightModel, NeverReplacesOtherFiles) {
  run(import);
  const std::string train =
      R"({"op": "train_light", "edits": [{"op": "bend", "degrees": 60}], )" + few + R"(, "out": ")";
  const auto source = folder_bytes(folder_.path() / "ball");
  expect_error(train + R"({here}/ball/mlp.json"})", "mlp.json");
  write_text(folder_.path() / "notes.txt", "mine");
  expect_error(train + R"({here}/notes.txt"})", "is not a model");
  EXPECT_EQ(folder_bytes(folder_.path() / "ball"), source);
  EXPECT_EQ(read_file(folder_.path() / "notes.txt"), "mine");
  expect_error(R"({"op": "use_light_model", "model": "{here}/notes.txt"})", "notes.txt");
}

TEST_F(LightModel, OfAnotherObjectIsRefused) {
  run(import);
  run(R"({"op": "train_light", "edits": [{"op": "bend", "degrees": 60}], "out": "{here}/m.light", )" + few + "}");
  Script::session.document = Document();
  run(R"({"op": "import", "path": "{here}/other", "as": "other"})");
  expect_error(R"({"op": "use_light_model", "model": "{here}/m.light"})", "another object");
}

}  // namespace
}  // namespace rebake::test
