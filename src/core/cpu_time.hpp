#pragma once
// Processor time, which other work on the machine disturbs far less than the clock on the wall.

#include <time.h>

namespace vitrum {

/// CPU time of this process so far, all threads and the system's part of it [s].
inline double process_cpu_seconds() {
  timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

}  // namespace vitrum
