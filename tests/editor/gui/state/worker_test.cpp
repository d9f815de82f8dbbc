// The window's Worker: jobs in order, snapshots, cancellation, callbacks for failed jobs. Its Previews.
#include "editor/gui/state/worker.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <thread>

#include "editor/edits/nodes/import.h"
#include "editor/edits/select/select.h"
#include "editor/edits/shape/delete_selected.h"
#include "editor/gui/state/previews.h"
#include "mesh_ops/base/error.h"
#include "mesh_ops/formats/export.h"
#include "tests/support/made_scenes.h"

namespace rebake::test {
namespace {

class WorkerTest : public ::testing::Test {
 protected:
  void wait() {
    while (worker.busy()) std::this_thread::yield();
  }
  Worker worker{[] {}};
};

TEST_F(WorkerTest, RunsJobsInOrderAndPublishesSnapshots) {
  const TemporaryFolder folder;
  export_scene(scene_of(made_object({.columns = 8, .rows = 4})), folder.path() / "ball", {});
  Import import;
  import.path = (folder.path() / "ball").string();
  bool told = false;
  worker.start(
      "import", [&](Session& session) { session.edit(import); }, [&] { told = true; });
  worker.start("bad", [](Session& session) { session.edit(DeleteSelected{}); });
  Select all;
  all.all = true;
  worker.start("select", [&](Session& session) { session.edit(all); });
  wait();
  const auto snapshot = worker.snapshot();
  EXPECT_EQ(snapshot->done.size(), 2U);
  ASSERT_EQ(snapshot->scene.roots.size(), 1U);
  EXPECT_NE(snapshot->scene.roots[0]->selection, nullptr);
  std::size_t failed = 0;
  for (const Worker::Message& message : worker.take_messages())
    failed += message.kind == Worker::Message::Kind::failed ? 1 : 0;
  EXPECT_EQ(failed, 1U);
  EXPECT_FALSE(told) << "callbacks run only in take_finished()";
  for (const auto& then : worker.take_finished()) then();
  EXPECT_TRUE(told);
}

TEST_F(WorkerTest, CancelStopsTheJobAndDropsTheQueue) {
  std::atomic<bool> begun = false;
  bool second = false;
  worker.start("long", [&](Session& session) {
    begun = true;
    for (;;) session.progress.at("waiting", 0.5);
  });
  worker.start("next", [&](Session&) { second = true; });
  while (!begun) std::this_thread::yield();
  worker.cancel();
  wait();
  EXPECT_FALSE(second);
  const auto messages = worker.take_messages();
  ASSERT_EQ(messages.size(), 2U);
  EXPECT_EQ(messages[0].text, "Not begun, and dropped too: next");
  EXPECT_EQ(messages[1].kind, Worker::Message::Kind::said) << "a cancelled job has not failed";
  EXPECT_NE(messages[1].text.find("cancelled"), std::string::npos);
}

// A key pressed while a project opens is meant for the document that is still shown.
TEST_F(WorkerTest, JobsForADocumentDoNotRunOnTheNextOne) {
  bool ran = false, told = false, any = false;
  worker.start(
      "open", [](Session& session) { ++session.document_number; }, {}, {}, Worker::On::any_document);
  worker.start(
      "save", [&](Session&) { ran = true; }, {}, [&] { told = true; });
  worker.start(
      "end", [&](Session&) { any = true; }, {}, {}, Worker::On::any_document);
  wait();
  for (const auto& then : worker.take_finished()) then();
  EXPECT_FALSE(ran);
  EXPECT_TRUE(told && any);
  ASSERT_EQ(worker.take_messages().size(), 1U);
  worker.saw(*worker.snapshot());
  worker.start("save", [&](Session&) { ran = true; });
  wait();
  EXPECT_TRUE(ran);
}

// A preview is shown until its job has ended, so its owner must hear of every end.
TEST_F(WorkerTest, CallbacksReportFailedAndDroppedJobs) {
  int done = 0, otherwise = 0;
  const auto start = [&](const char* title, Worker::Job job) {
    worker.start(
        title, std::move(job), [&] { ++done; }, [&] { ++otherwise; });
  };
  start("good", [](Session&) {});
  start("bad", [](Session&) { throw Error("no"); });
  wait();
  std::atomic<bool> begun = false;
  start("long", [&](Session& session) {
    begun = true;
    for (;;) session.progress.at("waiting", 0.5);
  });
  start("next", [](Session&) {});
  while (!begun) std::this_thread::yield();
  worker.cancel();
  wait();
  for (const auto& then : worker.take_finished()) then();
  EXPECT_EQ(done, 1);
  EXPECT_EQ(otherwise, 3);
}

TEST(Previews, MakesOnlyTheLatest) {
  Previews previews([] {});
  std::atomic<int> made = 0;
  for (int k = 0; k < 100; ++k)
    previews.request({}, [&made, k](const Progress&) {
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
      ++made;
      Scene scene;
      scene.next_id = static_cast<std::uint64_t>(k + 1);
      return scene;
    });
  while (previews.busy()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  const std::optional<Preview> last = previews.take();
  ASSERT_TRUE(last);
  EXPECT_EQ(last->scene.next_id, 100U);
  EXPECT_LT(made, 100) << "older requests must be skipped";
  EXPECT_FALSE(previews.take()) << "once";
  previews.request({}, [](const Progress&) -> Scene { throw EditError("no"); });
  while (previews.busy()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  EXPECT_FALSE(previews.take()) << "a failed edit gives no preview";
}

TEST(Previews, RefinesWhileIdle) {
  const auto numbered = [](std::uint64_t number) {
    Scene scene;
    scene.next_id = number;
    return scene;
  };
  Previews previews([] {});
  std::atomic<bool> refining = false;
  previews.request(
      {}, [&](const Progress&) { return numbered(1); },
      [&](const Progress&) {
        refining = true;
        while (refining) std::this_thread::yield();
        return numbered(2);
      });
  while (!refining) std::this_thread::yield();
  EXPECT_EQ(previews.take()->scene.next_id, 1U) << "the first preview is available during refinement";
  refining = false;
  while (previews.busy()) std::this_thread::yield();
  EXPECT_EQ(previews.take()->scene.next_id, 2U);
  // A new request cancels the refinement.
  previews.request(
      {}, [&](const Progress&) { return numbered(3); },
      [&](const Progress& progress) {
        refining = true;
        for (;;) progress.at("waiting", 0);
        return numbered(4);
      });
  while (!refining) std::this_thread::yield();
  previews.request({}, [&](const Progress&) { return numbered(5); });
  while (previews.busy()) std::this_thread::yield();
  EXPECT_EQ(previews.take()->scene.next_id, 5U);
}

}  // namespace
}  // namespace rebake::test
