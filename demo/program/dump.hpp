#pragma once
// Everything an independent check of a frame needs, in files (demo/README.md lists them).

#include <filesystem>

#include "demo/host/renderer.hpp"
#include "demo/program/frame_log.hpp"

namespace gnomon::demo {

/// Writes frame.json, depth.pfm, normals.pfm, offset.pfm, offset_<light>.pfm, visibility_<light>.png and casters.obj
/// for the renderer's newest frame.
void dumpFrame(const std::filesystem::path& folder, const Scene& scene, Renderer& renderer,
               const std::vector<FrameLog::LightLine>& lines);

} // namespace gnomon::demo
