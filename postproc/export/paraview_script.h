/// open_in_paraview.py: a view of an export in ParaView.
#pragma once

namespace drumsweep {

/// Python text for `paraview --script=` and for `pvpython`, where it writes a picture: open_in_paraview.py [PICTURE.png].
extern const char* const paraview_script;

}  // namespace drumsweep
