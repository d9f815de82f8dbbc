#include "mesh_ops/base/source_guard.h"

#include <sys/stat.h>

#include <algorithm>
#include <deque>

#include "mesh_ops/base/error.h"
#include "mesh_ops/base/file_calls.h"
#include "mesh_ops/base/files.h"

namespace rebake {

namespace fs = std::filesystem;

fs::path plain_path(const fs::path& path) {
  std::error_code error;
  fs::path named = fs::absolute(path);
  // A dangling link: writing through it creates its target.
  constexpr int max_links = 40;
  for (int k = 0; k < max_links && fs::is_symlink(named, error) && !fs::exists(named, error); ++k)
    named = named.parent_path() / fs::read_symlink(named, error);
  fs::path result = fs::weakly_canonical(named, error);
  if (error) result = named.lexically_normal();
  return result.has_filename() ? result : result.parent_path();
}

namespace {

// Number of entries after which the search for links and protected files stops; no scene has more.
constexpr std::size_t max_entries = 20000;

bool lies_in(const fs::path& path, const fs::path& folder) {
  return std::mismatch(folder.begin(), folder.end(), path.begin(), path.end()).first == folder.end();
}

// Calls `visit` with the entries below a folder, level by level, without following links. All entries of the folder
// itself are visited, and at most max_entries below.
template <class Visit>
void for_each_entry(const fs::path& folder, const Visit& visit) {
  std::size_t count = 0;
  for (std::deque<fs::path> waiting{folder}; !waiting.empty(); waiting.pop_front()) {
    const bool limited = waiting.front() != folder;
    std::error_code error;
    for (fs::directory_iterator at(waiting.front(), fs::directory_options::skip_permission_denied, error), end;
         !error && at != end; at.increment(error)) {
      if (limited && ++count > max_entries) return;
      visit(*at);
      std::error_code ignored;
      if (!at->is_symlink(ignored) && at->is_directory(ignored)) waiting.push_back(at->path());
    }
  }
}

}  // namespace

std::vector<SourceGuard::Identity> SourceGuard::identity_of(const fs::path& path) {
  struct stat about {};
  if (file_calls().stat(path.c_str(), &about) != 0) return {};
  return {{about.st_dev, about.st_ino, file_calls().birth_time(path.c_str())}};
}

bool SourceGuard::was_seen(const Source& source, const std::vector<Identity>& there) {
  // Another birth: the file was removed since, and a new one has its inode.
  return !there.empty() && std::any_of(source.seen.begin(), source.seen.end(), [&](const Identity& one) {
    return one == there.front() && (one.born == there.front().born || one.born == 0 || there.front().born == 0);
  });
}

bool SourceGuard::is_same(const Source& source, const fs::path& path) {
  const std::vector<Identity> there = identity_of(path);
  return !there.empty() && (was_seen(source, there) || there == identity_of(source.path));
}

void SourceGuard::add(const fs::path& folder, IsScene is_scene) {
  add_folder(plain_path(folder), "a source of this scene", is_scene);
}

void SourceGuard::add_folder(const fs::path& folder, const std::string& role, IsScene is_scene, const fs::path& owner) {
  // Many nodes share a source; its links are searched once.
  if (add_source({folder, true, role, identity_of(folder), false, owner})) add_link_targets(folder, is_scene, owner);
}

void SourceGuard::add_link_targets(const fs::path& folder, IsScene is_scene, const fs::path& owner) {
  const std::string linked = "the target of a link in a source of this scene";
  for_each_entry(folder, [&](const fs::directory_entry& entry) {
    std::error_code ignored;
    if (!entry.is_symlink(ignored)) return;
    const fs::path target = plain_path(entry.path());
    if (lies_in(target, folder)) return;
    if (!fs::is_directory(target, ignored)) {
      add_source({target, false, linked, identity_of(target), false, owner});
      return;
    }
    // The scene reads a linked folder if it is a scene, or contains some.
    if (is_scene(target)) {
      add_folder(target, linked, is_scene, owner);
      return;
    }
    for_each_entry(target, [&](const fs::directory_entry& below) {
      std::error_code error;
      if (below.is_directory(error) && is_scene(below.path()))
        add_folder(plain_path(below.path()), linked, is_scene, owner);
    });
  });
}

void SourceGuard::add_file(const fs::path& source, const std::string& role) {
  const fs::path path = plain_path(source);
  add_source({path, false, role, identity_of(path), false, {}});
}

void SourceGuard::add_contents(const fs::path& folder, const std::string& role, IsScene is_scene) {
  const fs::path path = plain_path(folder);
  if (add_source({path, true, role, identity_of(path), true, {}})) add_link_targets(path, is_scene, path);
}

void SourceGuard::add_all(const SourceGuard& other, const std::string& role) {
  for (Source source : other.sources_) {
    source.role = role;
    source.replaceable = false;
    source.owner.clear();
    // A known source keeps its role.
    for (const Source& known : sources_)
      if (known.path == source.path && known.is_folder == source.is_folder) source.role = known.role;
    add_source(std::move(source));
  }
}

void SourceGuard::release_contents(const fs::path& folder) {
  const fs::path path = plain_path(folder);
  std::erase_if(sources_, [&](const Source& source) {
    return source.owner == path || (source.replaceable && is_same(source, path));
  });
}

void SourceGuard::release(const fs::path& folder) {
  const fs::path path = plain_path(folder);
  std::erase_if(sources_, [&](const Source& source) {
    return source.path == path || *source.path.lexically_relative(path).begin() != "..";
  });
}

bool SourceGuard::add_source(Source source) {
  for (Source& known : sources_)
    if (known.path == source.path && known.is_folder == source.is_folder) {
      // The source may have been replaced since. Undo and journals still need the earlier one if it was moved.
      if (!source.seen.empty() && !was_seen(known, source.seen)) known.seen.push_back(source.seen.front());
      known.replaceable = known.replaceable && source.replaceable;
      // Several folders link to it: it stays protected when one of them is replaced.
      if (source.owner != known.owner) known.owner.clear();
      known.role = std::move(source.role);
      return false;
    }
  sources_.push_back(std::move(source));
  return true;
}

const SourceGuard::Source* SourceGuard::source_holding(const fs::path& wanted) const {
  for (const Source& source : sources_) {
    const auto may_go = [&](const fs::path& at) { return source.replaceable && at == wanted; };
    if (lies_in(wanted, source.path) && !may_go(source.path)) return &source;
    for (fs::path at = wanted;; at = at.parent_path()) {
      if (is_same(source, at) && !may_go(at)) return &source;
      // Only a folder protects its contents.
      if (!source.is_folder || at == at.parent_path()) break;
    }
  }
  return nullptr;
}

void SourceGuard::check_file(const fs::path& path) const {
  check_parents(path);
  const fs::path wanted = plain_path(path);
  if (const Source* source = source_holding(wanted))
    throw FileError(path, source->is_folder
                              ? "would be written into \"" + source->path.string() + "\", " + source->role +
                                    ", which undo, journals and projects read again; choose another place"
                              : "is " + source->role + "; choose another name");
}

void SourceGuard::check_folder(const fs::path& path) const {
  const fs::path wanted = plain_path(path);
  check_file(path);
  const auto refuse = [&](const Source& source) {
    throw FileError(path, "contains \"" + source.path.string() + "\", " + source.role +
                              ", which would be lost; write to another folder");
  };
  for (const Source& source : sources_) {
    if (lies_in(source.path, wanted) && !(source.replaceable && source.path == wanted)) refuse(source);
    for (fs::path at = source.path.parent_path(); at != at.parent_path(); at = at.parent_path())
      if (const auto there = identity_of(at); !there.empty() && there == identity_of(wanted)) refuse(source);
  }
  // A hard link or a mount below the folder may lead to a source.
  std::vector<std::vector<Identity>> identities;
  for (const Source& source : sources_) identities.push_back(identity_of(source.path));
  for_each_entry(wanted, [&](const fs::directory_entry& entry) {
    std::error_code ignored;
    if (entry.is_symlink(ignored)) return;
    const std::vector<Identity> there = identity_of(entry.path());
    for (std::size_t k = 0; k < sources_.size(); ++k)
      if (!there.empty() && (there == identities[k] || was_seen(sources_[k], there))) refuse(sources_[k]);
  });
}

}  // namespace rebake
