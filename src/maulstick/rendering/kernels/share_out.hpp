// Work that is shared out to threads.
#pragma once
#include <algorithm>
#include <atomic>
#include <cstdint>
#include <system_error>
#include <thread>
#include <vector>

namespace maulstick {

// Runs work(task, thread) for each task on up to `threads` threads.
template <class Work>
void share_out(int64_t tasks, int64_t threads, Work work) {
  std::atomic<int64_t> next{0};
  auto run = [&](int64_t thread) {
    for (int64_t task; (task = next.fetch_add(1)) < tasks;) work(task, thread);
  };
  std::vector<std::thread> helpers;
  try {
    for (int64_t i = 1; i < std::min(threads, tasks); ++i) helpers.emplace_back(run, i);
  } catch (const std::system_error&) {       // the system gives no more threads: go on with fewer
  }
  run(0);
  for (std::thread& helper : helpers) helper.join();
}

}  // namespace maulstick
