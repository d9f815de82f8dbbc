#include "mesh_ops/base/file_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <thread>

#include "mesh_ops/base/error.h"

namespace rebake {

FileLock::FileLock(const std::filesystem::path& path)
    : file_(::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NONBLOCK | O_NOCTTY, 0666)) {
  if (file_ < 0) throw FileError(path, "cannot be written");
  held_ = ::flock(file_, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK;
}

FileLock::~FileLock() { ::close(file_); }

FolderLock::FolderLock(const std::filesystem::path& folder, Wait wait)
    : folder_(::open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
  constexpr std::chrono::milliseconds patience{10000}, pause{20};
  const auto end = std::chrono::steady_clock::now() + patience;
  while (folder_ >= 0 && ::flock(folder_, LOCK_EX | LOCK_NB) != 0 && (errno == EWOULDBLOCK || errno == EINTR)) {
    if (wait == Wait::no && errno == EWOULDBLOCK) {
      held_ = false;
      return;
    }
    if (std::chrono::steady_clock::now() > end) {
      ::close(folder_);
      throw FileError(folder, "is locked by another program that writes a project there; try again");
    }
    std::this_thread::sleep_for(pause);
  }
}

FolderLock::~FolderLock() {
  if (folder_ >= 0) ::close(folder_);
}

}  // namespace rebake
