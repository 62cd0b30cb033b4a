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

/// What an earlier dump left in the folder; its frame.json says which files of lights are its own.
void removeOldDump(const std::filesystem::path& folder);

} // namespace gnomon::demo
