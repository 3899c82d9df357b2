// Between a program and oclgrind: tools/check_races loads it before oclgrind's runtime, whose check of memory that
// nobody wrote is of use only with it.
//
// oclgrind 21.10 follows what kernels write byte by byte, but not what the host does. With each write, copy and fill it
// takes the part that is written for the whole of the buffer; all else then counts as never written, whoever writes it.
// What is copied counts as written, and a new buffer takes over what was known of one that was freed. So here a kernel
// copies parts, and nothing is freed. Nor does oclgrind look at what the host reads, so a kernel reads that first.
//
// Only of what src/device/opencl.cpp calls; a program that maps buffers or has them made of its own memory wants more.

#define CL_TARGET_OPENCL_VERSION 120
#include <CL/cl.h>
#include <dlfcn.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <map>
#include <vector>

namespace {

// copy_words: a struct is copied with what is known of its bytes and without a report, which is for whoever uses them;
// through pointers to bytes, since oclgrind looks into structs that it can tell. read_by_host: of words it reports.
constexpr const char* source = R"(
typedef struct { uchar bytes[4]; } Word;
kernel void copy_words(global const uchar* from, ulong first, global uchar* to, ulong to_first) {
  const size_t i = 4 * get_global_id(0);
  *(global Word*)(to + to_first + i) = *(global const Word*)(from + first + i);
}
kernel void read_by_host(global const uint* from, ulong first, global uint* seen) {
  seen[get_global_id(0)] = from[first / 4 + get_global_id(0)];
})";

// Larger reads are not looked at: the host takes photons in flight together with the room behind them, which it passes
// over (photons_of_runs in src/render/photon_pass.cpp).
constexpr size_t largest_read = 65536;

void need(bool good, const char* what) {
  if (good) return;
  std::fprintf(stderr, "vitrum: error: tools/oclgrind_memory.cpp: %s failed\n", what);
  std::abort();
}

cl_context context_of(cl_command_queue queue) {
  cl_context context;
  need(clGetCommandQueueInfo(queue, CL_QUEUE_CONTEXT, sizeof context, &context, nullptr) == CL_SUCCESS, "the context");
  return context;
}

struct Kernels {
  cl_kernel copy_words, read_by_host;
};

const Kernels& kernels_for(cl_command_queue queue) {
  static std::map<cl_context, Kernels> made;
  const cl_context context = context_of(queue);
  if (!made.contains(context)) {
    cl_device_id device;
    need(clGetCommandQueueInfo(queue, CL_QUEUE_DEVICE, sizeof device, &device, nullptr) == CL_SUCCESS, "the device");
    const char* text = source;
    const cl_program program = clCreateProgramWithSource(context, 1, &text, nullptr, nullptr);
    need(program != nullptr && clBuildProgram(program, 1, &device, "", nullptr, nullptr) == CL_SUCCESS, "the build");
    made[context] = {clCreateKernel(program, "copy_words", nullptr), clCreateKernel(program, "read_by_host", nullptr)};
    clRetainContext(context);  // so that no other gets its address
  }
  return made[context];
}

cl_mem new_buffer(cl_command_queue queue, size_t size) {
  const cl_mem buffer = clCreateBuffer(context_of(queue), CL_MEM_READ_WRITE, size, nullptr, nullptr);
  need(buffer != nullptr, "a buffer");
  return buffer;
}

template <typename T>
void set_argument(cl_kernel kernel, cl_uint index, const T& value) {
  need(clSetKernelArg(kernel, index, sizeof value, &value) == CL_SUCCESS, "an argument");
}

/// Launches `kernel` on the words of `size` bytes.
cl_int launch(cl_command_queue queue, cl_kernel kernel, size_t size, cl_uint n_waits, const cl_event* waits,
              cl_event* event) {
  need(size % 4 == 0, "a size in whole words");
  const size_t words = size / 4;
  return clEnqueueNDRangeKernel(queue, kernel, 1, nullptr, &words, nullptr, n_waits, waits, event);
}

/// oclgrind's own function of that name.
template <typename Function>
Function* next_one(Function*, const char* name) {
  return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

}  // namespace

extern "C" {

cl_int clReleaseMemObject(cl_mem) { return CL_SUCCESS; }

cl_int clEnqueueCopyBuffer(cl_command_queue queue, cl_mem from, cl_mem to, size_t first, size_t to_first, size_t size,
                           cl_uint n_waits, const cl_event* waits, cl_event* event) {
  const cl_kernel kernel = kernels_for(queue).copy_words;
  set_argument(kernel, 0, from);
  set_argument(kernel, 1, cl_ulong{first});
  set_argument(kernel, 2, to);
  set_argument(kernel, 3, cl_ulong{to_first});
  return launch(queue, kernel, size, n_waits, waits, event);
}

cl_int clEnqueueWriteBuffer(cl_command_queue queue, cl_mem to, cl_bool blocks, size_t first, size_t size,
                            const void* data, cl_uint n_waits, const cl_event* waits, cl_event* event) {
  static const auto write = next_one(&clEnqueueWriteBuffer, "clEnqueueWriteBuffer");
  size_t whole = 0;
  need(clGetMemObjectInfo(to, CL_MEM_SIZE, sizeof whole, &whole, nullptr) == CL_SUCCESS, "the size of a buffer");
  if (size == whole) return write(queue, to, blocks, first, size, data, n_waits, waits, event);
  const cl_mem part = new_buffer(queue, size);
  need(write(queue, part, CL_TRUE, 0, size, data, 0, nullptr, nullptr) == CL_SUCCESS, "a write");
  const cl_int code = clEnqueueCopyBuffer(queue, part, to, 0, first, size, n_waits, waits, event);
  return code == CL_SUCCESS && blocks ? clFinish(queue) : code;
}

cl_int clEnqueueReadBuffer(cl_command_queue queue, cl_mem from, cl_bool blocks, size_t first, size_t size, void* data,
                           cl_uint n_waits, const cl_event* waits, cl_event* event) {
  static const auto read = next_one(&clEnqueueReadBuffer, "clEnqueueReadBuffer");
  if (size <= largest_read) {
    const cl_kernel kernel = kernels_for(queue).read_by_host;
    set_argument(kernel, 0, from);
    set_argument(kernel, 1, cl_ulong{first});
    set_argument(kernel, 2, new_buffer(queue, size));
    need(launch(queue, kernel, size, n_waits, waits, nullptr) == CL_SUCCESS, "a read");
  }
  return read(queue, from, blocks, first, size, data, n_waits, waits, event);
}

cl_int clEnqueueFillBuffer(cl_command_queue queue, cl_mem to, const void* pattern, size_t pattern_size, size_t first,
                           size_t size, cl_uint n_waits, const cl_event* waits, cl_event* event) {
  std::vector<char> data(size);
  for (size_t i = 0; i < size; i += pattern_size) std::memcpy(&data[i], pattern, pattern_size);
  return clEnqueueWriteBuffer(queue, to, CL_TRUE, first, size, data.data(), n_waits, waits, event);
}

}  // extern "C"
