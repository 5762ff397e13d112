/// Rendered pictures of a drum or a scene: balls, walls, belt, with colour bar and scale bar, through POV-Ray.
///
/// The projection is parallel, so that the scale bar holds all over the picture. A drum is cut open along its axis, by a plane that
/// faces the viewer; of other walls only the sides show that balls touch and that face the viewer.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "postproc/still.h"

namespace drumsweep {

struct PictureOptions {
  int width = 1400, height = 900;  ///< pixels
  std::string colour =
      "speed";  ///< or "height"; for drums "slot": the way out that was taken; "axial": place along the axis
  std::string view = "all";  ///< or, for drums, "outlet": that end with the belt under it
  bool soft_shadows = true;  ///< false: a quarter of the time, for films
};

/// What is the same in all pictures of an animation: camera and colours.
struct PictureFrame {
  Eigen::Vector3d right, up, into;  ///< unit vectors of the picture
  Eigen::Vector3d centre;           ///< of the picture [m]
  double metres_per_pixel = 0;
  double depth = 0;                  ///< all that is drawn is nearer than this to the centre, along `into` [m]
  double low = 0, high = 1;          ///< ends of the colour scale, in the unit of colour_label
  double tick = 1;                   ///< from one number beside the scale to the next
  std::string colour_label;          ///< "speed (m/s)"; empty where colours are classes
  std::vector<std::string> classes;  ///< their names, the first for what has none: "in the drum", "slot 1" ...
};

/// @throws InputError for a colour or a view that only a drum has, or when there is neither ball nor wall
PictureFrame picture_frame(const Still& still, const PictureOptions& options);

/// Text of a POV-Ray scene. @param caption  below the picture
std::string pov_scene(const Still& still, const PictureOptions& options, const PictureFrame& frame,
                      const std::string& caption);

/// PNG. @throws std::runtime_error when POV-Ray is missing or fails
std::string rendered(const Still& still, const PictureOptions& options, const PictureFrame& frame,
                     const std::string& caption);

/// @param path  of the PNG. @throws InputError, WriteError, std::runtime_error as above
void write_picture(const Still& still, const PictureOptions& options, const std::string& path);

/// @throws InputError saying how to install POV-Ray
void need_povray();

}  // namespace drumsweep
