#include "editor/cli/terminal.h"

#include <fmt/format.h>
#include <semaphore.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <mutex>
#include <string>
#include <thread>
#include <utility>

#include "mesh_ops/base/duration.h"
#include "mesh_ops/base/partial_writes.h"

namespace rebake {

namespace {

std::atomic<bool> interrupted = false;
sem_t asked_to_end;

// Work that polls its Progress stops on its own. Work that has not stopped within this time is abandoned, so that the
// process ends within a second of the signal.
constexpr int stopped_by_signal = 130;  // exit code
constexpr std::chrono::milliseconds work_ends_within{600}, moves_end_within{200};

// Watcher thread: ends the process some time after a signal.
void end_when_asked() {
  while (::sem_wait(&asked_to_end) != 0 && errno == EINTR) {
  }
  std::this_thread::sleep_for(work_ends_within);
  abandon_writes(moves_end_within);
  ::_exit(stopped_by_signal);
}

}  // namespace

void stop_on_interrupt() {
  ::sem_init(&asked_to_end, 0, 0);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    const auto before = std::signal(signal, [](int number) {
      interrupted = true;
      ::sem_post(&asked_to_end);
      std::signal(number, SIG_DFL);
    });
    if (before == SIG_IGN) std::signal(signal, SIG_IGN);  // as under nohup
  }
  // Signals are blocked in the watcher, so that other threads handle them.
  sigset_t all, before;
  ::sigfillset(&all);
  ::pthread_sigmask(SIG_SETMASK, &all, &before);
  std::thread(end_when_asked).detach();
  ::pthread_sigmask(SIG_SETMASK, &before, nullptr);
}

void write_stderr(const std::string& text) { std::fputs(text.c_str(), stderr); }

bool is_interactive() {
  static const bool yes = isatty(STDERR_FILENO) == 1;
  return yes;
}

std::string coloured(const std::string& text, const char* sgr) {
  static const bool colour = is_interactive() && std::getenv("NO_COLOR") == nullptr;
  return colour ? fmt::format("\033[{}m{}\033[0m", sgr, text) : text;
}

Progress progress_bar() {
  if (!is_interactive()) {
    // No bar, but a log gets each estimate of the remaining time once.
    auto said = std::make_shared<std::pair<std::mutex, std::string>>();
    return Progress(
        [said](std::string_view what, double) {
          const std::size_t at = what.find(about);
          if (at == std::string_view::npos) return;
          const std::scoped_lock lock(said->first);
          // The text after the time counts steps and is cut off.
          const std::string words(what.substr(0, what.find(", ", at + 1)));
          if (std::exchange(said->second, words) != words) write_stderr(fmt::format("note: {}\n", words));
        },
        &interrupted);
  }
  auto state = std::make_shared<std::pair<std::mutex, std::chrono::steady_clock::time_point>>();
  return Progress(
      [state](std::string_view what, double share) {
        const std::scoped_lock lock(state->first);
        const auto now = std::chrono::steady_clock::now();
        if (share < 1 && now - state->second < std::chrono::milliseconds(100)) return;
        state->second = now;
        if (share >= 1) return clear_progress_bar();
        const auto filled = static_cast<std::size_t>(share * 30);
        write_stderr(fmt::format("\r\033[K{} [{}{}] {:3.0f} %", what, std::string(filled, '#'),
                                 std::string(30 - filled, ' '), share * 100));
      },
      &interrupted);
}

void clear_progress_bar() {
  if (is_interactive()) write_stderr("\r\033[K");
}

std::string printable(std::string_view text) {
  std::string result;
  for (std::size_t k = 0; k < text.size(); ++k) {
    const auto c = static_cast<unsigned char>(text[k]);
    // C1 controls are two bytes in UTF-8.
    const bool c1 = c == 0xC2 && k + 1 < text.size() && static_cast<unsigned char>(text[k + 1]) < 0xA0;
    if (c1)
      result += fmt::format("\\x{:02x}", static_cast<unsigned char>(text[++k]));
    else if ((c < 32 && c != '\n' && c != '\t') || c == 127)
      result += fmt::format("\\x{:02x}", c);
    else
      result += static_cast<char>(c);
  }
  return result;
}

void print_message(const std::string& line) {
  clear_progress_bar();
  write_stderr(printable(line) + "\n");
}

}  // namespace rebake
