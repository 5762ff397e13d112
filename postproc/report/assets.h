/// Style and script of the pages, from style.css and script.js; see CMakeLists.txt.
#pragma once

namespace drumsweep {

struct PageAsset {
  const char *name, *text;
};
extern const PageAsset page_assets[];
extern const int num_page_assets;

}  // namespace drumsweep
