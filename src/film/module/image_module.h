#pragma once
// The C interface between vitrum and its image module (vitrum_images.so), which holds OpenImageIO. Nothing of C++
// crosses it: no exception, no object, no memory that one side allocates and the other frees.

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/// Raised by every change of what stands here, so that a module of another build is refused.
#define VITRUM_IMAGE_MODULE_VERSION 2
/// The one symbol of the module, a function of type VitrumImageModuleEntry.
#define VITRUM_IMAGE_MODULE_ENTRY "vitrum_image_module"

typedef enum {
  VITRUM_IMAGE_OK,
  VITRUM_IMAGE_NOT_A_PICTURE,  ///< no reader knows the file, or it holds something else (volumes, deep pixels)
  VITRUM_IMAGE_TOO_LARGE,      ///< more pixels than allowed, or than there is memory for
  VITRUM_IMAGE_DAMAGED,        ///< cut short, or what it holds contradicts itself
  VITRUM_IMAGE_FAILED,         ///< could not be encoded
} VitrumImageStatus;

/// Why a call failed, in OpenImageIO's words; "" if it has none.
typedef struct {
  char text[512];
} VitrumImageMessage;

/// Gives room for width * height * 3 floats, or NULL if there is none. Called once, before any pixel is read.
typedef float* (*VitrumImageAllocate)(void* user, int width, int height);

/// What a file holds, all its channels.
typedef struct {
  int width, height, channels;
  const char* const* channel_names;  ///< `channels` of them, in the order of the values; valid during the call
  int is_float;                      ///< 0: integers, which are read as 0..1
} VitrumImageContents;

/// Gives room for width * height * channels floats, or NULL if there is none. Called once, before any pixel is read.
typedef float* (*VitrumImageAllocateChannels)(void* user, const VitrumImageContents* contents);

/// Takes the bytes of an encoded file. Called once. Returns 0 if there is no room for them.
typedef int (*VitrumImageTake)(void* user, const void* bytes, size_t size);

/// A picture to be encoded.
typedef struct {
  const char* extension;             ///< of the format, without the dot
  int width, height, channels;
  const char* const* channel_names;  ///< `channels` of them
  const float* values;               ///< interleaved, row 0 at the top
  int is_float;                      ///< 1: 32-bit float; 0: 8-bit, 0..1 becomes 0..255
  int is_srgb;                       ///< 1: the values carry the sRGB curve, and the file may say so
  const char* software;              ///< name and version of the program
  int metadata_count;
  const char* const* metadata_keys;
  const char* const* metadata_values;
} VitrumImageToEncode;

typedef struct {
  int version;  ///< VITRUM_IMAGE_MODULE_VERSION
  /// Decodes the file at `path` as RGB; grey is spread. Refuses pictures of more than `max_pixels` pixels unread.
  VitrumImageStatus (*read)(const char* path, uint64_t max_pixels, VitrumImageAllocate allocate, void* user,
                            VitrumImageMessage* message);
  /// Decodes all channels of the file at `path`, interleaved; of a file of several pictures, those of the first.
  /// Refuses pictures of more than `max_pixels` pixels or `max_values` values unread.
  VitrumImageStatus (*read_channels)(const char* path, uint64_t max_pixels, uint64_t max_values,
                                     VitrumImageAllocateChannels allocate, void* user, VitrumImageMessage* message);
  /// Encodes `image` in memory. The same image gives the same bytes.
  VitrumImageStatus (*encode)(const VitrumImageToEncode* image, VitrumImageTake take, void* user,
                              VitrumImageMessage* message);
} VitrumImageModule;

typedef const VitrumImageModule* (*VitrumImageModuleEntry)(void);

#ifdef __cplusplus
}
#endif
