#pragma once
// Reading and writing pictures. OpenImageIO stands behind it, in a process that the first call starts.

#include <glm/glm.hpp>
#include <map>
#include <string>
#include <vector>

#include "core/error.hpp"
#include "film/display.hpp"

namespace vitrum {

/// Pixels as they lie in a file, decoded to floats, row 0 at the top.
struct Picture {
  int width = 0, height = 0;
  std::vector<glm::vec3> pixels;            ///< width * height; grey is spread over the three channels
};

/// A named plane of a picture that is to be written. EXR takes several as layers, which viewers know by the names of
/// their channels: R, G, B for the beauty, "albedo.R" and so on for other colours, "normal.X" and so on for what is no
/// colour, "depth.Z" for the depth. Other formats take the first layer.
struct PictureLayer {
  std::string name;                         ///< "beauty", "normal", ... ; "" or "beauty" become the plain R, G, B
  int channels = 3;                         ///< 1 or 3
  std::vector<float> values;                ///< width * height * channels, linear
  bool is_colour = true;                    ///< takes the display transform in PNG and the like; what is no colour is
                                            ///< made visible there by show_data_in_place (display.hpp)
};

/// Refuses what is no ordinary file with something in it, before anything waits for it or reads it without end. Cheap:
/// does not tell whether it is a picture. Throws Error at `asked_by`.
void check_readable(const std::string& path, const SourceLocation& asked_by);

/// Reads a picture; values are as in the file (0..1 for integer formats), without any colour transform.
/// Throws Error at `asked_by` for a file that is missing, no picture, cut short, or of more than 2^28 pixels, or that
/// ends the process. Thread-safe; one picture is read or written at a time.
Picture read_picture(const std::string& path, const SourceLocation& asked_by);

/// A picture with all that its file holds.
struct LayeredPicture {
  int width = 0, height = 0;
  bool is_float = false;                    ///< floats, which as a rule are linear; else integers, read as 0..1
  std::vector<PictureLayer> layers;         ///< in the order of their first channels in the file
};

/// Reads a picture with all its layers, the inverse of write_picture: channels R, G, B or X, Y, Z of one prefix are a
/// layer of three channels, any other channel is one by itself. A layer has the name of the prefix, without a prefix
/// that of a colour is "beauty"; grey without a prefix is spread over three channels. A channel that would take a name
/// that is taken has its full name, and so have plain ones, such as "A". Values and errors are those of read_picture,
/// and a file of more than 3 * 2^28 values is refused, too.
LayeredPicture read_layers(const std::string& path, const SourceLocation& asked_by);

/// Checks that a picture can be written to `path`: a known extension, a folder that exists and can be written.
/// Throws Error; called before rendering begins. Does not start the process, nor touch the file.
void check_writable(const std::string& path);

/// What write_picture writes, as bytes. Throws Error at {path}.
std::string picture_file(const std::string& path, int width, int height, const std::vector<PictureLayer>& layers,
                         const DisplaySettings& display, const std::map<std::string, std::string>& metadata);

/// Writes layers to `path`, whole or not at all (core/whole_file.hpp). The same input gives the same bytes.
/// .exr: 32-bit float, linear, all layers. .hdr: linear, first layer. .png, .jpg, .tif, .bmp: 8-bit, first layer, with
/// the display transform. `metadata` goes into the file's header where the format has room, with the version of vitrum:
/// in EXR and PNG as "vitrum:KEY", in JPEG and TIFF within the description. Throws Error at {path}.
void write_picture(const std::string& path, int width, int height, const std::vector<PictureLayer>& layers,
                   const DisplaySettings& display, const std::map<std::string, std::string>& metadata);

/// Whether write_picture needs the process for pictures. Throws Error at {path} if it would refuse the name.
bool takes_image_process(const std::string& path);

/// Starts the process for pictures, so that a later call finds it ready; does not wait for that. It ends with the
/// program. Throws Error without a place if it cannot be started.
void start_image_process();

/// Ends the process for pictures, so that the end of the program need not; does not wait for that. A later call that
/// reads or writes a picture starts another.
void end_image_process();

}  // namespace vitrum
