// Stands before oclgrind's OpenCL in tools/second_device. oclgrind 21.10 takes for uninitialised what was filled by
// clEnqueueFillBuffer or copied by clEnqueueCopyBuffer; here both go through the host, whose writes it sees.
#define CL_TARGET_OPENCL_VERSION 120
#include <CL/cl.h>
#include <stdlib.h>
#include <string.h>

cl_int clEnqueueFillBuffer(cl_command_queue queue, cl_mem buffer, const void* pattern, size_t pattern_size, size_t offset,
                           size_t size, cl_uint n_events, const cl_event* events, cl_event* event) {
  char* values = malloc(size);
  if (!values) return CL_OUT_OF_HOST_MEMORY;
  for (size_t i = 0; i < size; i += pattern_size) memcpy(values + i, pattern, pattern_size);
  const cl_int error = clEnqueueWriteBuffer(queue, buffer, CL_TRUE, offset, size, values, n_events, events, event);
  free(values);
  return error;
}

cl_int clEnqueueCopyBuffer(cl_command_queue queue, cl_mem from, cl_mem to, size_t from_offset, size_t to_offset, size_t size,
                           cl_uint n_events, const cl_event* events, cl_event* event) {
  void* values = malloc(size);
  if (!values) return CL_OUT_OF_HOST_MEMORY;
  cl_int error = clEnqueueReadBuffer(queue, from, CL_TRUE, from_offset, size, values, n_events, events, NULL);
  if (error == CL_SUCCESS) error = clEnqueueWriteBuffer(queue, to, CL_TRUE, to_offset, size, values, 0, NULL, event);
  free(values);
  return error;
}
