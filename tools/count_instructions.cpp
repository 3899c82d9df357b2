// Between a program and PoCL: tools/count_instructions loads it first. It stops after each instruction of the kernels that
// are named (the processor's trap flag) and counts where.
//
// COUNTED_KERNELS: names, a space between. COUNTS: the file for what was counted, a line for each: the object's file, the
// address in it, how often.

#include <dlfcn.h>
#include <signal.h>
#include <ucontext.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <map>
#include <string>
#include <utility>

namespace {

using Workgroup = void (*)(uint8_t* arguments, uint8_t* context, unsigned long x, unsigned long y, unsigned long z);

constexpr size_t most_kernels = 16, most_bytes = 1 << 20;

struct Counted {
  Workgroup kernel = nullptr;
  std::string file;
  uintptr_t base = 0;
  uint64_t counts[most_bytes] = {};
};

Counted* counted[most_kernels];
Counted* running = nullptr;
size_t n_counted = 0;

void count_one(int, siginfo_t*, void* context) {
  const auto at = static_cast<uintptr_t>(static_cast<ucontext_t*>(context)->uc_mcontext.gregs[REG_RIP]);
  if (running != nullptr && at - running->base < most_bytes) ++running->counts[at - running->base];
}

constexpr unsigned long trap_flag = 0x100;
void set_trap() { asm volatile("pushfq\n orq %0, (%%rsp)\n popfq" ::"i"(trap_flag) : "cc", "memory"); }
void clear_trap() { asm volatile("pushfq\n andq %0, (%%rsp)\n popfq" ::"i"(~trap_flag) : "cc", "memory"); }

template <size_t k>
void call_counted(uint8_t* arguments, uint8_t* context, unsigned long x, unsigned long y, unsigned long z) {
  running = counted[k];
  set_trap();
  running->kernel(arguments, context, x, y, z);
  clear_trap();
  running = nullptr;
}

template <size_t... k>
Workgroup stand_in(size_t which, std::index_sequence<k...>) {
  static constexpr Workgroup all[] = {&call_counted<k>...};
  return all[which];
}

bool is_wanted(const char* symbol) {
  const char* names = std::getenv("COUNTED_KERNELS");
  if (names == nullptr || std::strncmp(symbol, "_pocl_kernel_", 13) != 0 || std::strstr(symbol, "_workgroup") == nullptr) return false;
  const std::string kernel(symbol + 13, std::strstr(symbol, "_workgroup"));
  return (" " + std::string(names) + " ").find(" " + kernel + " ") != std::string::npos;
}

__attribute__((destructor)) void write_counts() {
  const char* path = std::getenv("COUNTS");
  std::FILE* file = path != nullptr && n_counted > 0 ? std::fopen(path, "w") : nullptr;
  if (file == nullptr) return;
  for (size_t k = 0; k < n_counted; ++k)
    for (size_t at = 0; at < most_bytes; ++at)
      if (counted[k]->counts[at] > 0) std::fprintf(file, "%s %zx %lu\n", counted[k]->file.c_str(), at, counted[k]->counts[at]);
  std::fclose(file);
}

}  // namespace

extern "C" void* dlsym(void* handle, const char* symbol) {
  using Find = void* (*)(void*, const char*);
  static const Find find = reinterpret_cast<Find>(dlvsym(RTLD_NEXT, "dlsym", "GLIBC_2.2.5"));
  void* const found = find(handle, symbol);
  Dl_info info;
  if (found == nullptr || !is_wanted(symbol) || n_counted == most_kernels || dladdr(found, &info) == 0) return found;
  if (n_counted == 0) {
    struct sigaction action = {};
    action.sa_sigaction = count_one;
    action.sa_flags = SA_SIGINFO;
    sigaction(SIGTRAP, &action, nullptr);
  }
  auto* const one = new Counted;
  one->kernel = reinterpret_cast<Workgroup>(found);
  one->file = info.dli_fname;
  one->base = reinterpret_cast<uintptr_t>(info.dli_fbase);
  counted[n_counted] = one;
  return reinterpret_cast<void*>(stand_in(n_counted++, std::make_index_sequence<most_kernels>()));
}
