// Durable file writes: order of syncs and renames under power loss, full disks, short writes, leftovers, pipes and
// devices. SourceGuard, which protects sources from being overwritten.
#include "mesh_ops/base/files.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/mount.h>
#include <sys/stat.h>

#include <cerrno>
#include <fstream>
#include <functional>
#include <random>

#include "mesh_ops/base/error.h"
#include "mesh_ops/base/file_calls.h"
#include "mesh_ops/formats/export.h"
#include "mesh_ops/formats/formats.h"
#include "mesh_ops/formats/scene_files.h"
#include "tests/support/made_scenes.h"
#include "tests/support/power_loss.h"

namespace rebake::test {
namespace {

namespace fs = std::filesystem;

void write_text(const fs::path& path, const std::string& text) { std::ofstream(path, std::ios::binary) << text; }

TEST(Files, SyncsFilesBeforeRenameAndFoldersAfter) {
  const TemporaryFolder folder;
  PowerLoss calls;
  const ReplacedFileCalls in_use(calls);
  write_file_atomically(folder.path() / "a.txt", "one", {});
  write_file_atomically(folder.path() / "a.txt", "two", {});
  export_scene(scene_of(made_object()), folder.path() / "new" / "deeper", {});
  export_scene(scene_of(made_object()), folder.path() / "new" / "deeper", {});
  format_named("rebake").write(scene_of(made_object()), folder.path() / "scene", {}, {});
  EXPECT_EQ(calls.renames(), 5U);
  EXPECT_EQ(calls.violations(), "") << "a power loss would lose data";
  EXPECT_EQ(read_file(folder.path() / "a.txt"), "two");
}

TEST(Files, FullDiskAtAnyCallKeepsPreviousFiles) {
  const TemporaryFolder folder;
  const auto object = made_object({.columns = 6, .rows = 4});
  export_scene(scene_of(object), folder.path() / "out", {});
  write_file_atomically(folder.path() / "note", "before", {});
  const auto before = folder_bytes(folder.path() / "out");
  // Half of the object, so that its bytes differ.
  TriangleSet half(object->triangle_count());
  for (std::size_t f = 0; f < half.size(); ++f) half[f] = f % 2;
  BakedObject changed = *object;
  changed.sets[0].soup = subset(object->sets[0].soup, half, 0, true);
  changed.sets.resize(1);
  const Scene scene = scene_of(std::make_shared<const BakedObject>(changed));
  std::size_t failures = 0;
  for (int nth = 0;; ++nth) {
    PowerLoss calls;
    calls.fail_at(nth, ENOSPC);
    const ReplacedFileCalls in_use(calls);
    bool failed = false;
    try {
      export_scene(scene, folder.path() / "out", {});
      write_file_atomically(folder.path() / "note", "after", {});
    } catch (const FileError& error) {
      failed = true;
      EXPECT_NE(std::string(error.what()).find("No space left"), std::string::npos) << error.what();
    }
    if (!failed) break;
    ++failures;
    const bool replaced = calls.renames() > 0;  // the rename succeeded, a later sync failed
    if (!replaced) {
      EXPECT_EQ(folder_bytes(folder.path() / "out"), before) << "call " << nth;
    } else {
      // The folder is complete: the old one or the new one.
      EXPECT_NO_THROW(read_any(folder.path() / "out", Axes::y_up));
      EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), {}), 2) << "nothing half-written, call " << nth;
    }
    if (read_file(folder.path() / "note") != "before") {
      EXPECT_EQ(read_file(folder.path() / "note"), "after");
      write_text(folder.path() / "note", "before");
    }
    fs::remove_all(folder.path() / "out");
    export_scene(scene_of(object), folder.path() / "out", {});
  }
  EXPECT_GT(failures, 10U);
}

TEST(Files, ContinuesShortWrites) {
  const TemporaryFolder folder;
  PowerLoss calls;
  calls.write_at_most(3);
  const ReplacedFileCalls in_use(calls);
  write_file_atomically(folder.path() / "a", "a longer text than three bytes", {});
  EXPECT_EQ(read_file(folder.path() / "a"), "a longer text than three bytes");
}

TEST(Files, DoesNotReplaceWriteProtected) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "kept", scene = folder.path() / "scene";
  write_file_atomically(file, "what was there", {});
  fs::permissions(file, fs::perms::owner_read);
  EXPECT_THROW(write_file_atomically(file, "new", {}), FileError);
  EXPECT_EQ(read_file(file), "what was there");
  fs::create_directory(scene);
  fs::permissions(scene, fs::perms::owner_read | fs::perms::owner_exec);
  EXPECT_THROW(AtomicFolder(scene, {}, [](const fs::path&) {}), FileError);
  fs::permissions(scene, fs::perms::owner_all);
  write_text(scene / "original", "precious");
  fs::permissions(scene / "original", fs::perms::owner_read);
  EXPECT_THROW(AtomicFolder(scene, {}, [](const fs::path&) {}), FileError);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), {}), 2) << "nothing half-written";
}

TEST(Files, DoesNotReplaceTheCurrentFolder) {
  const TemporaryFolder folder;
  fs::create_directories(folder.path() / "at/below");
  const fs::path before = fs::current_path();
  fs::current_path(folder.path() / "at/below");
  for (const char* out : {".", "..", "../../at"})
    EXPECT_THROW(AtomicFolder(out, {}, [](const fs::path&) {}), FileError) << out;
  {
    const AtomicFolder beside("../beside", {}, [](const fs::path&) {});
  }
  fs::current_path(before);
}

TEST(Files, RemovesOnlyLeftoversOfKilledWrites) {
  const TemporaryFolder folder;
  fs::create_directory(folder.path() / ".out.01234567.rebake-partial");
  write_text(folder.path() / ".out.01234567.rebake-partial" / "mlp.json", "half");
  write_text(folder.path() / "note.89abcdef.rebake-partial", "half");
  for (const char* kept : {"note.txt.rebake-partial", "out.0123.rebake-partial", ".other.01234567.rebake-partial"})
    write_text(folder.path() / kept, "mine");
  export_scene(scene_of(made_object()), folder.path() / "out", {});
  write_file_atomically(folder.path() / "note", "whole", {});
  EXPECT_FALSE(fs::exists(folder.path() / ".out.01234567.rebake-partial"));
  EXPECT_FALSE(fs::exists(folder.path() / "note.89abcdef.rebake-partial"));
  for (const char* kept : {"note.txt.rebake-partial", "out.0123.rebake-partial", ".other.01234567.rebake-partial"})
    EXPECT_TRUE(fs::exists(folder.path() / kept)) << kept;
}

// Download programs write parts of such names.
TEST(Files, KeepsPartsOfOtherPrograms) {
  const TemporaryFolder folder;
  for (const char* name : {"note.1a2b3c4d.partial", ".out.1a2b3c4d.partial"})
    write_text(folder.path() / name, "theirs");
  write_file_atomically(folder.path() / "note", "whole", {});
  export_scene(scene_of(made_object()), folder.path() / "out", {});
  for (const char* name : {"note.1a2b3c4d.partial", ".out.1a2b3c4d.partial"})
    EXPECT_EQ(read_file(folder.path() / name), "theirs");
}

// The disk of its target may not be mounted.
TEST(Files, KeepsLinksToNothing) {
  const TemporaryFolder folder;
  for (const char* target : {"/nowhere/note", "note"}) {
    fs::create_symlink(target, folder.path() / "link");
    try {
      write_file_atomically(folder.path() / "link", "whole", {});
      FAIL() << target;
    } catch (const FileError& error) {
      EXPECT_NE(std::string(error.what()).find("is a link to a file or folder that does not exist"), std::string::npos);
    }
    EXPECT_THROW(export_scene(scene_of(made_object()), folder.path() / "link", {}), FileError);
    EXPECT_THROW(check_can_export(folder.path() / "link", {}), FileError);
    EXPECT_TRUE(fs::is_symlink(folder.path() / "link"));
    fs::remove(folder.path() / "link");
  }
}

// A user may open a leftover as a source to recover it: an export must not remove it then.
TEST(Files, KeepsLeftoversThatAreSources) {
  const TemporaryFolder folder;
  const fs::path leftover = folder.path() / ".out.01234567.rebake-partial",
                 file = folder.path() / "note.89abcdef.rebake-partial";
  fs::create_directory(leftover);
  write_text(leftover / "mlp.json", "a source");
  write_text(file, "a camera");
  SourceGuard guard;
  protect_scene(guard, leftover);
  guard.add_file(file);
  AtomicFolder out(folder.path() / "out", guard, [](const fs::path&) {});
  out.write("a", "b");
  out.commit();
  write_file_atomically(folder.path() / "note", "text", guard);
  EXPECT_TRUE(fs::exists(leftover / "mlp.json"));
  EXPECT_TRUE(fs::exists(file));
}

// The target is checked again before it is replaced: a parent folder may have become a link to a source meanwhile.
TEST(Files, ChecksTargetAgainBeforeReplacing) {
  const TemporaryFolder folder;
  fs::create_directories(folder.path() / "sources/ficus");
  write_text(folder.path() / "sources/ficus/mlp.json", "precious");
  fs::create_directory(folder.path() / "results");
  SourceGuard guard;
  protect_scene(guard, folder.path() / "sources/ficus");
  AtomicFolder out(folder.path() / "results/ficus", guard, [](const fs::path&) {});
  out.write("mlp.json", "new");
  // The staging folder moves too, so that only the check can fail.
  for (const fs::directory_entry& entry : fs::directory_iterator(folder.path() / "results"))
    fs::rename(entry.path(), folder.path() / "sources" / entry.path().filename());
  fs::rename(folder.path() / "results", folder.path() / "aside");
  fs::create_directory_symlink(folder.path() / "sources", folder.path() / "results");
  EXPECT_THROW(out.commit(), FileError);
  EXPECT_EQ(read_file(folder.path() / "sources/ficus/mlp.json"), "precious");
}

TEST(Files, RejectsPipesAndDevices) {
  const TemporaryFolder folder;
  ASSERT_EQ(::mkfifo((folder.path() / "pipe").c_str(), 0600), 0);
  EXPECT_THROW(read_file(folder.path() / "pipe"), FileError);
  EXPECT_THROW(read_file("/dev/zero"), FileError);
  EXPECT_THROW(read_input("/dev/zero", 1 << 20), FileError);
  write_text(folder.path() / "large", std::string(100, 'x'));
  EXPECT_THROW(read_file(folder.path() / "large", 99), FileError);
  // A pipe in place of a file of a scene folder.
  export_scene(scene_of(made_object()), folder.path() / "scene", {});
  fs::remove(folder.path() / "scene" / "shape0.obj");
  ASSERT_EQ(::mkfifo((folder.path() / "scene" / "shape0.obj").c_str(), 0600), 0);
  EXPECT_THROW(read_any(folder.path() / "scene", Axes::y_up), FileError);
}

TEST(Files, ResolvesDotDotBehindLinks) {
  const TemporaryFolder folder;
  const fs::path root = fs::canonical(folder.path());
  fs::create_directories(root / "deep/er");
  fs::create_directory_symlink(root / "deep/er", root / "link");
  EXPECT_EQ(absolute_path(root / "link/../x"), root / "deep/x");
  EXPECT_EQ(absolute_path(root / "link/x/"), root / "link/x");
  EXPECT_EQ(absolute_path(root / "./deep//er/."), root / "deep/er");
  EXPECT_EQ(absolute_path("/"), "/");
}

TEST(SourceGuard, RejectsSourceParentsChildrenAndLinks) {
  const TemporaryFolder folder;
  fs::create_directories(folder.path() / "x/ficus/below");
  fs::create_directory_symlink(folder.path() / "x/ficus", folder.path() / "link");
  SourceGuard guard;
  protect_scene(guard, folder.path() / "x/ficus");
  for (const char* refused :
       {"x/ficus", "x/ficus/", "x", "x/ficus/below", "x/ficus/new/deeper", "link", "x/./ficus/../ficus"})
    EXPECT_THROW(guard.check_folder(folder.path() / refused), FileError) << refused;
  for (const char* refused : {"x/ficus/shape0.obj", "x/ficus/below/p.png", "link/p.rebake"})
    EXPECT_THROW(guard.check_file(folder.path() / refused), FileError) << refused;
  for (const char* allowed : {"x/other", "y", "x/ficus2"}) EXPECT_NO_THROW(guard.check_folder(folder.path() / allowed));
  EXPECT_NO_THROW(guard.check_file(folder.path() / "x/p.png"));
}

// A function that returns an alias of the path `real`, with `scratch` as folder for links.
struct Alias {
  std::string name;
  std::function<fs::path(const fs::path& real, const fs::path& scratch)> make;
};
const std::vector<Alias> aliases{
    {"itself", [](const fs::path& real, const fs::path&) { return real; }},
    {"dots",
     [](const fs::path& real, const fs::path&) { return real.parent_path() / "." / real.filename() / "." / ""; }},
    {"link",
     [](const fs::path& real, const fs::path& scratch) {
       fs::create_directory_symlink(real, scratch / "link");
       return scratch / "link";
     }},
    {"link to a link",
     [](const fs::path& real, const fs::path& scratch) {
       fs::create_directory_symlink(real, scratch / "one");
       fs::create_directory_symlink(scratch / "one", scratch / "two");
       return scratch / "two";
     }},
    {"through a linked parent",
     [](const fs::path& real, const fs::path& scratch) {
       fs::create_directory_symlink(real.parent_path(), scratch / "parent");
       return scratch / "parent" / real.filename();
     }},
};

// All combinations of an alias for reading and an alias for writing.
TEST(SourceGuard, RecognisesEveryAliasOfAFolder) {
  for (const Alias& read : aliases)
    for (const Alias& written : aliases) {
      const TemporaryFolder folder;
      const fs::path real = folder.path() / "data/scene";
      fs::create_directories(real);
      fs::create_directories(folder.path() / "a");
      fs::create_directories(folder.path() / "b");
      SourceGuard guard;
      protect_scene(guard, read.make(real, folder.path() / "a"));
      const fs::path out = written.make(real, folder.path() / "b");
      EXPECT_THROW(guard.check_folder(out), FileError) << read.name << " / " << written.name;
      EXPECT_THROW(guard.check_file(out / "shape0.obj"), FileError) << read.name << " / " << written.name;
      EXPECT_THROW(guard.check_folder(out / "new"), FileError) << read.name << " / " << written.name;
    }
}

TEST(SourceGuard, ProtectsFilesThatASourceLinksTo) {
  const TemporaryFolder folder;
  fs::create_directories(folder.path() / "real");
  fs::create_directories(folder.path() / "linked");
  for (const char* name : {"mlp.json", "shape0.obj"}) {
    write_file_atomically(folder.path() / "real" / name, "text", {});
    fs::create_symlink(folder.path() / "real" / name, folder.path() / "linked" / name);
  }
  SourceGuard guard;
  protect_scene(guard, folder.path() / "linked");
  EXPECT_THROW(guard.check_folder(folder.path() / "real"), FileError) << "the source links to files in this folder";
  EXPECT_THROW(guard.check_file(folder.path() / "real/mlp.json"), FileError);
  EXPECT_NO_THROW(guard.check_file(folder.path() / "real/other.json"));
  fs::create_hard_link(folder.path() / "real/mlp.json", folder.path() / "hard.json");
  EXPECT_THROW(guard.check_file(folder.path() / "hard.json"), FileError);
}

TEST(WriteFileAtomically, RefusesNamesThatChecksOfTheFileWouldNotFind) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "file";
  fs::create_directory(folder.path() / "sub");
  fs::create_symlink("nowhere", folder.path() / "dangling");
  write_file_atomically(file, "old", {});
  std::mt19937 random(3);
  const char* const parts[] = {"sub", "missing", "file", "dangling", "..", "."};
  int written = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    fs::path path = folder.path();
    for (unsigned k = random() % 4; k > 0; --k) path /= parts[random() % std::size(parts)];
    path /= "file";
    if (random() % 3 == 0) path = path.string() + (random() % 2 == 0 ? "/" : "/.");
    // Paths may lead out of the folder.
    if (!fs::weakly_canonical(path).string().starts_with(folder.path().string())) continue;
    std::error_code error;
    const bool found = fs::exists(path, error);
    bool wrote = true;
    try {
      write_file_atomically(path, "new", {});
    } catch (const FileError&) {
      wrote = false;
    }
    EXPECT_EQ(wrote && !found && read_file(file) == "new", false) << path << ": a check would not have found the file";
    written += wrote ? 1 : 0;
    fs::remove_all(folder.path() / "sub/file");
    write_file_atomically(file, "old", {});
  }
  EXPECT_GT(written, 50);
}

// Simulates two paths to one file without a link: a bind mount, or a case-insensitive file system.
class OneFileTwoNames : public FileCalls {
 public:
  OneFileTwoNames(fs::path name, fs::path other) : name_(std::move(name)), other_(std::move(other)) {}
  int stat(const char* path, struct stat* about) override {
    const fs::path asked(path);
    const fs::path rest = asked.lexically_relative(other_);
    const bool below = !rest.empty() && *rest.begin() != "..";
    return FileCalls::stat(below ? (name_ / rest).lexically_normal().c_str() : path, about);
  }

 private:
  fs::path name_, other_;
};

TEST(SourceGuard, ComparesDevicesAndInodes) {
  const TemporaryFolder folder;
  fs::create_directories(folder.path() / "data/Scene");
  fs::create_directories(folder.path() / "mount/Scene");
  OneFileTwoNames calls(folder.path() / "data/", folder.path() / "mount/");
  const ReplacedFileCalls in_use(calls);
  SourceGuard guard;
  protect_scene(guard, folder.path() / "mount/Scene");
  EXPECT_THROW(guard.check_folder(folder.path() / "data/Scene"), FileError);
  EXPECT_THROW(guard.check_file(folder.path() / "data/Scene/shape0.obj"), FileError);
  EXPECT_THROW(guard.check_folder(folder.path() / "data"), FileError) << "contains the source under its other path";
  EXPECT_NO_THROW(guard.check_folder(folder.path() / "elsewhere"));
}

// Simulates a file system that gives the inode of a removed file to the next one.
class ReusedInodes : public FileCalls {
 public:
  std::int64_t born = 1;
  int stat(const char* path, struct stat* about) override {
    const int result = FileCalls::stat(path, about);
    if (fs::path(path).extension() == ".png") about->st_ino = 77;
    return result;
  }
  std::int64_t birth_time(const char*) override { return born; }
};

TEST(SourceGuard, ForgetsInodesOfRemovedFiles) {
  const TemporaryFolder folder;
  ReusedInodes calls;
  const ReplacedFileCalls in_use(calls);
  write_text(folder.path() / "read.png", "1");
  SourceGuard guard;
  guard.add_file(folder.path() / "read.png");
  fs::rename(folder.path() / "read.png", folder.path() / "moved.png");
  EXPECT_THROW(guard.check_file(folder.path() / "moved.png"), FileError) << "undo and journals read it again";
  fs::remove(folder.path() / "moved.png");
  calls.born = 2;
  write_text(folder.path() / "new.png", "2");
  EXPECT_NO_THROW(guard.check_file(folder.path() / "new.png"));
}

TEST(SourceGuard, FollowsLinksToFoldersOfLinks) {
  const TemporaryFolder folder;
  for (const char* name : {"a", "links", "scene"}) fs::create_directories(folder.path() / name);
  write_text(folder.path() / "a/mlp.json", "{}");
  fs::create_symlink(folder.path() / "a/mlp.json", folder.path() / "links/mlp.json");
  fs::create_symlink(folder.path() / "links", folder.path() / "scene/b");
  SourceGuard guard;
  protect_scene(guard, folder.path() / "scene");
  EXPECT_THROW(guard.check_file(folder.path() / "links/mlp.json"), FileError);
  EXPECT_THROW(guard.check_file(folder.path() / "a/mlp.json"), FileError);
  EXPECT_THROW(guard.check_folder(folder.path() / "a"), FileError);
}

TEST(SourceGuard, ProtectsLinkTargetsOfReplaceableScenesUntilReplaced) {
  const TemporaryFolder folder;
  const fs::path texture = folder.path() / "textures/a.png";
  fs::create_directories(folder.path() / "scene");
  fs::create_directories(folder.path() / "textures");
  std::ofstream(texture) << "texels";
  fs::create_symlink(texture, folder.path() / "scene/shape0.pngfeat0.png");
  SourceGuard guard;
  protect_scene_contents(guard, folder.path() / "scene", "a scene that this script reads");
  EXPECT_THROW(guard.check_file(texture), FileError);
  EXPECT_NO_THROW(guard.check_folder(folder.path() / "scene"));
  guard.release_contents(folder.path() / "scene");
  EXPECT_NO_THROW(guard.check_file(texture));
}

TEST(SourceGuard, KeepsTargetsThatSeveralScenesLinkTo) {
  const TemporaryFolder folder;
  const fs::path texture = folder.path() / "textures/a.png";
  fs::create_directories(folder.path() / "textures");
  std::ofstream(texture) << "texels";
  SourceGuard guard;
  for (const char* scene : {"one", "two"}) {
    fs::create_directories(folder.path() / scene);
    fs::create_symlink(texture, folder.path() / scene / "shape0.pngfeat0.png");
    protect_scene_contents(guard, folder.path() / scene, "a scene that this script reads");
  }
  guard.release_contents(folder.path() / "one");
  EXPECT_THROW(guard.check_file(texture), FileError) << "the other scene still reads it";
}

TEST(SourceGuard, ProtectsObjectsBehindALinkToTheirParent) {
  const TemporaryFolder folder;
  fs::create_directories(folder.path() / "library/ficus");
  std::ofstream(folder.path() / "library/ficus/mlp.json") << "{}";
  fs::create_directories(folder.path() / "library/notes");
  fs::create_directories(folder.path() / "scene");
  fs::create_directory_symlink(folder.path() / "library", folder.path() / "scene/objects");
  SourceGuard guard;
  protect_scene(guard, folder.path() / "scene");
  EXPECT_THROW(guard.check_folder(folder.path() / "library/ficus"), FileError);
  EXPECT_THROW(guard.check_file(folder.path() / "library/ficus/p.png"), FileError);
  EXPECT_NO_THROW(guard.check_file(folder.path() / "library/notes/p.png"));
}

// Photographs beside a scene must not hide its links.
TEST(SourceGuard, IgnoresFoldersThatCannotBeExamined) {
  const TemporaryFolder folder;
  export_scene(scene_of(made_object()), folder.path() / "scene", {});
  // A path so long that no file in it can be named.
  fs::path deep = folder.path() / "tree";
  for (constexpr std::size_t longest = 4090, part = 200; deep.native().size() < longest;) {
    deep /= std::string(std::min(part, longest - deep.native().size() - 1), 'a');
    fs::create_directories(deep);
  }
  fs::create_directory_symlink(folder.path() / "tree", folder.path() / "scene/more");
  SourceGuard guard;
  EXPECT_NO_THROW(protect_scene(guard, folder.path() / "scene"));
  EXPECT_THROW(guard.check_file(folder.path() / "scene/mlp.json"), FileError);
}

TEST(SourceGuard, FindsLinksBesideManyFiles) {
  const TemporaryFolder folder;
  const fs::path texture = folder.path() / "textures/a.png";
  fs::create_directories(folder.path() / "textures");
  std::ofstream(texture) << "texels";
  fs::create_directories(folder.path() / "scene/frames");
  for (int k = 0; k < 20100; ++k) std::ofstream(folder.path() / "scene/frames" / std::to_string(k));
  fs::create_symlink(texture, folder.path() / "scene/shape0.pngfeat0.png");
  SourceGuard guard;
  protect_scene(guard, folder.path() / "scene");
  EXPECT_THROW(guard.check_file(texture), FileError);
}

TEST(SourceGuard, RecognisesMovedSources) {
  const TemporaryFolder folder;
  fs::create_directories(folder.path() / "scene");
  SourceGuard guard;
  protect_scene(guard, folder.path() / "scene");
  fs::rename(folder.path() / "scene", folder.path() / "moved");
  for (int twice = 0; twice < 2; ++twice) {
    EXPECT_THROW(guard.check_file(folder.path() / "moved/shape0.obj"), FileError);
    EXPECT_THROW(guard.check_folder(folder.path() / "moved"), FileError);
    protect_scene(guard, folder.path() / "scene");  // repeated, as for each node read from there
  }
  // A new folder at the old path is a source too.
  fs::create_directories(folder.path() / "scene");
  protect_scene(guard, folder.path() / "scene");
  EXPECT_THROW(guard.check_folder(folder.path() / "scene"), FileError);
  EXPECT_THROW(guard.check_folder(folder.path() / "moved"), FileError);
}

TEST(SourceGuard, FollowsLinksToFilesThatDoNotExistYet) {
  const TemporaryFolder folder;
  fs::create_directories(folder.path() / "scene");
  fs::create_symlink("scene/report.jsonl", folder.path() / "link");
  fs::create_symlink("link", folder.path() / "another");
  SourceGuard guard;
  protect_scene(guard, folder.path() / "scene");
  EXPECT_THROW(guard.check_file(folder.path() / "link"), FileError);
  EXPECT_THROW(guard.check_file(folder.path() / "another"), FileError);
}

TEST(SourceGuard, AllowsReplacingContentsAsAWholeOnly) {
  const TemporaryFolder folder;
  const fs::path scene = folder.path() / "scene";
  fs::create_directories(scene);
  fs::create_directory_symlink("scene", folder.path() / "link");
  SourceGuard guard;
  protect_scene_contents(guard, scene, "a scene that this script reads");
  EXPECT_NO_THROW(guard.check_folder(scene));
  EXPECT_NO_THROW(guard.check_folder(folder.path() / "link"));
  for (const char* inside : {"scene/mlp.json", "link/mlp.json", "scene/more/x.png"})
    EXPECT_THROW(guard.check_file(folder.path() / inside), FileError) << inside;
  EXPECT_THROW(guard.check_folder(scene / "more"), FileError);
  EXPECT_THROW(guard.check_folder(folder.path()), FileError);
  SourceGuard released = guard;
  released.release_contents(folder.path() / "link");
  EXPECT_NO_THROW(released.check_file(scene / "mlp.json"));
  protect_scene(guard, scene);
  EXPECT_THROW(guard.check_folder(scene), FileError) << "imported";
}

TEST(SourceGuard, RecognisesBindMounts) {
  const TemporaryFolder folder;
  fs::create_directories(folder.path() / "data/scene");
  fs::create_directories(folder.path() / "mount");
  if (::mount((folder.path() / "data").c_str(), (folder.path() / "mount").c_str(), nullptr, MS_BIND, nullptr) != 0)
    GTEST_SKIP() << "mounting is not permitted";
  SourceGuard guard;
  protect_scene(guard, folder.path() / "mount/scene");
  EXPECT_THROW(guard.check_folder(folder.path() / "data/scene"), FileError);
  EXPECT_THROW(guard.check_folder(folder.path() / "data"), FileError);
  EXPECT_THROW(guard.check_file(folder.path() / "data/scene/shape0.obj"), FileError);
  // A folder in which something is mounted is not replaced: its files would be removed with the old folder.
  write_text(folder.path() / "data/mine.txt", "mine");
  const auto replace = [&] {
    AtomicFolder out(folder.path(), {}, [](const fs::path&) {});
    out.commit();
  };
  EXPECT_THROW(replace(), FileError);
  EXPECT_TRUE(fs::exists(folder.path() / "data/mine.txt"));
  ::umount((folder.path() / "mount").c_str());
}

TEST(Files, RejectsPipeWithoutReader) {
  const TemporaryFolder folder;
  const fs::path pipe = folder.path() / "pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_THROW(write_file_atomically(pipe, "bytes", {}), FileError);
}

// Another program may write into the target while the new contents are written.
TEST(AtomicFolder, KeepsFilesThatAppearInTheTargetMeanwhile) {
  TemporaryFolder folder;
  const fs::path target = folder.path() / "scene";
  const auto refuse_notes = [](const fs::path& replaced) {
    if (fs::exists(replaced / "notes.txt")) throw FileError(replaced, "contains notes");
  };
  for (int round = 0; round < 2; ++round) {
    AtomicFolder out(target, {}, refuse_notes);
    out.write("mlp.json", std::to_string(round));
    if (round == 0) {
      out.commit();
      continue;
    }
    write_text(target / "notes.txt", "mine");
    try {
      out.commit();
      ADD_FAILURE() << "replaced the notes";
    } catch (const FileError& error) {
      EXPECT_NE(std::string(error.what()).find("received other files"), std::string::npos) << error.what();
    }
  }
  EXPECT_EQ(read_file(target / "notes.txt"), "mine");
  EXPECT_EQ(read_file(target / "mlp.json"), "0");
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), fs::directory_iterator()), 1);
}

}  // namespace
}  // namespace rebake::test
